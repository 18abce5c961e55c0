#include "api/result/csv.hpp"

#include <cmath>
#include <functional>

#include "api/result/history_columns.hpp"
#include "api/result/study_columns.hpp"

namespace signorini::api {
namespace {

constexpr std::string_view end_of_line = "\r\n";

std::string quoted_field(std::string_view text) {
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

/// A text as one field.
std::string field_of(std::string_view text) {
  std::string field(text);
  const bool guarded =
      !text.empty() && std::string_view("=+-@\t\r\n'").find(text.front()) != std::string_view::npos;
  if (guarded) field.insert(field.begin(), '\'');
  const bool plain = field.find_first_of(",\"\r\n") == std::string::npos;
  return plain ? field : quoted_field(field);
}

void put_row(PieceWriter& out, const ContactPart& part, const std::string& name, std::size_t row) {
  out.put(name);
  for (const double number :
       {part.points[row].x(), part.points[row].y(), part.clearance[row], part.pressure[row], part.gap[row]}) {
    out.put(',');
    out.put_digits(number);
  }
  out.put(part.open[row] ? ",true" : ",false");
  out.put(end_of_line);
}

void put_number(PieceWriter& out, double number) {
  out.put_digits(number);
}

void put_number(PieceWriter& out, int number) {
  out.put(std::to_string(number));
}

/// One column of a history: its name, and what writes its entry.
struct Column {
  std::string_view name;
  std::function<void(PieceWriter&, const Iteration&)> put_entry;
};

std::vector<Column> columns_of(const std::vector<Iteration>& history) {
  std::vector<Column> columns;
  for_each_history_column(history.empty() ? nullptr : &history.front(), [&](std::string_view name,
                                                                            const auto& entry) {
    columns.push_back({name, [entry](PieceWriter& out, const Iteration& i) { put_number(out, entry(i)); }});
  });
  return columns;
}

/// Writes a cell as one field.
struct PutCell {
  PieceWriter& out;

  void operator()(std::monostate) const {}
  void operator()(std::int64_t number) const { out.put_digits(number); }
  void operator()(double number) const { out.put_digits(number); }
  void operator()(bool truth) const { out.put(truth ? "true" : "false"); }
  void operator()(const std::string& text) const { out.put(field_of(text)); }
};

/// One line, `put_field` writing the field of each column.
template <typename AnyColumn, typename PutField>
void put_line(PieceWriter& out, const std::vector<AnyColumn>& columns, const PutField& put_field) {
  for (const AnyColumn& column : columns) {
    if (&column != &columns.front()) out.put(',');
    put_field(column);
  }
  out.put(end_of_line);
}

}  // namespace

bool write_history_csv(const std::vector<Iteration>& history, const Sink& sink) {
  const std::vector<Column> columns = columns_of(history);
  return write_all(sink, [&](PieceWriter& out) {
    put_line(out, columns, [&](const Column& column) { out.put(column.name); });
    for (const Iteration& iteration : history)
      put_line(out, columns, [&](const Column& column) { column.put_entry(out, iteration); });
  });
}

bool write_study_csv(const std::vector<StudyRow>& rows, const Sink& sink) {
  const std::vector<StudyColumn> columns = study_columns(rows);
  return write_all(sink, [&](PieceWriter& out) {
    put_line(out, columns, [&](const StudyColumn& column) { out.put(field_of(column.name)); });
    for (std::size_t row = 0; row < rows.size(); ++row)
      put_line(out, columns, [&](const StudyColumn& column) { std::visit(PutCell{out}, column.cell(row)); });
  });
}

bool write_quantities_csv(const std::vector<EnclosedQuantity>& quantities, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    out.put("name,value,estimate,lower,upper,guaranteed");
    out.put(end_of_line);
    for (const EnclosedQuantity& own : quantities) {
      out.put(field_of(own.name));
      for (const double number : {own.value, own.estimate, own.lower, own.upper}) {
        out.put(',');
        if (std::isfinite(number)) out.put_digits(number);
      }
      out.put(own.guaranteed ? ",true" : ",false");
      out.put(end_of_line);
    }
  });
}

bool write_contact_csv(const std::vector<ContactPart>& parts, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    out.put("part,x,y,clearance,pressure,gap,open");
    out.put(end_of_line);
    for (const ContactPart& part : parts) {
      const std::string name = field_of(part.name);
      for (std::size_t row = 0; row < part.points.size(); ++row) put_row(out, part, name, row);
    }
  });
}

}  // namespace signorini::api
