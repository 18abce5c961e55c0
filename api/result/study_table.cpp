#include "api/result/study_table.hpp"

#include <algorithm>
#include <cstdio>
#include <span>

#include "api/names.hpp"
#include "api/result/study_columns.hpp"

namespace signorini::api {
namespace {

constexpr std::size_t widest_line = 100;
constexpr std::string_view between = "  ";

struct TextOfCell {
  std::string operator()(std::monostate) const { return {}; }
  std::string operator()(std::int64_t number) const { return std::to_string(number); }
  std::string operator()(bool truth) const { return truth ? "yes" : "no"; }
  std::string operator()(const std::string& text) const { return text; }
  std::string operator()(double number) const {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.4g", number);
    return digits;
  }
};

/// A column as it is printed: its name, a line a row, and the fitted rate.
struct TextColumn {
  std::vector<std::string> lines;

  std::size_t width() const { return std::ranges::max_element(lines, {}, &std::string::size)->size(); }
};

std::string fitted(const std::vector<StudyRow>& rows, Scheme scheme, const std::string& column) {
  for (const auto& [name, value] : falling_numbers())
    if (column == name + "_rate") return std::visit(TextOfCell{}, cell_of(fitted_rate(rows, scheme, value)));
  return column == "triangles" ? "fitted" : "";
}

std::vector<TextColumn> text_columns(const std::vector<StudyRow>& rows, Scheme scheme) {
  std::vector<TextColumn> texts;
  for (const StudyColumn& column : study_columns(rows)) {
    if (column.name == "scheme" || column.name == "error") continue;
    TextColumn text{{column.name}};
    for (std::size_t row = 0; row < rows.size(); ++row)
      if (rows[row].scheme == scheme && rows[row].error.empty())
        text.lines.push_back(std::visit(TextOfCell{}, column.cell(row)));
    text.lines.push_back(fitted(rows, scheme, column.name));
    // The rows are told by their triangles, at the start of every line.
    texts.insert(column.name == "triangles" ? texts.begin() : texts.end(), std::move(text));
  }
  return texts;
}

void put_right(PieceWriter& out, const TextColumn& column, std::size_t line) {
  out.put(std::string(column.width() - column.lines[line].size(), ' '));
  out.put(column.lines[line]);
}

void put_block(PieceWriter& out, const TextColumn& first, std::span<const TextColumn> others) {
  const bool has_rates =
      std::ranges::any_of(others, [](const TextColumn& column) { return !column.lines.back().empty(); });
  for (std::size_t line = 0; line + (has_rates ? 0 : 1) < first.lines.size(); ++line) {
    put_right(out, first, line);
    for (const TextColumn& column : others) {
      out.put(between);
      put_right(out, column, line);
    }
    out.put("\n");
  }
  out.put("\n");
}

/// As many of the columns as stand beside the first one in a line; one at least.
std::size_t fitting(const TextColumn& first, std::span<const TextColumn> columns) {
  std::size_t count = 0, width = first.width();
  while (count < columns.size() && (width += between.size() + columns[count].width()) <= widest_line) ++count;
  return std::max<std::size_t>(count, 1);
}

void put_scheme(PieceWriter& out, const std::vector<StudyRow>& rows, Scheme scheme) {
  out.put(name_in(scheme_names, scheme));
  out.put("\n\n");
  const std::vector<TextColumn> columns = text_columns(rows, scheme);
  if (!columns.empty())
    for (std::span<const TextColumn> left = std::span(columns).subspan(1); !left.empty();) {
      const std::size_t count = fitting(columns.front(), left);
      put_block(out, columns.front(), left.first(count));
      left = left.subspan(count);
    }
  for (const StudyRow& row : rows)
    if (row.scheme == scheme && !row.error.empty()) out.put("not solved: " + row.error + "\n\n");
}

}  // namespace

bool write_study_table(const std::vector<StudyRow>& rows, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    for (const Scheme scheme : schemes_of(rows)) put_scheme(out, rows, scheme);
  });
}

}  // namespace signorini::api
