#include "api/result/study_columns.hpp"

#include <cmath>

#include "api/names.hpp"

namespace signorini::api {
namespace {

/// The quotient, if there are both and it is a number.
std::optional<double> quotient(const std::optional<ErrorBound>& bound, const std::optional<double>& error) {
  if (!bound || !error || !(*error > 0)) return std::nullopt;
  return bound->value / *error;
}

std::optional<double> bound_of(const StudyRow& row) {
  return row.error_bound ? std::optional(row.error_bound->value) : std::nullopt;
}

/// What the row has if it was solved: `value(row)` as a cell.
using CellOfRow = std::function<Cell(const StudyRow&)>;

CellOfRow of_bound(double ErrorBound::Parts::*part) {
  return
      [part](const StudyRow& row) { return row.error_bound ? Cell(row.error_bound->parts.*part) : Cell(); };
}

const Names<CellOfRow>& columns_of_sizes() {
  static const Names<CellOfRow> columns{
      {"level", [](const StudyRow& row) { return row.level > 0 ? Cell(std::int64_t{row.level}) : Cell(); }},
      {"size", [](const StudyRow& row) { return Cell(row.size); }},
      {"triangles", [](const StudyRow& row) { return Cell(row.triangles); }},
      {"unknowns", [](const StudyRow& row) {
         const Unknowns& n = row.unknowns;
         return Cell(n.stress + n.displacement + n.contact + n.rotation);
       }}};
  return columns;
}

const Names<CellOfRow>& columns_of_bound() {
  static const Names<CellOfRow> columns{
      {"relative",
       [](const StudyRow& row) { return row.error_bound ? Cell(row.error_bound->relative) : Cell(); }},
      {"guaranteed",
       [](const StudyRow& row) { return row.error_bound ? Cell(row.error_bound->guaranteed) : Cell(); }},
      {"constitutive", of_bound(&ErrorBound::Parts::constitutive)},
      {"contact", of_bound(&ErrorBound::Parts::contact)},
      {"oscillation", of_bound(&ErrorBound::Parts::oscillation)},
      {"equilibration", of_bound(&ErrorBound::Parts::equilibration)},
      {"asymmetry", of_bound(&ErrorBound::Parts::asymmetry)},
      {"effectivity",
       [](const StudyRow& row) { return cell_of(quotient(row.error_bound, row.errors.total)); }},
      {"stress_effectivity",
       [](const StudyRow& row) { return cell_of(quotient(row.error_bound, row.errors.energy_norm)); }},
      {"energy", [](const StudyRow& row) { return Cell(row.energy); }},
      {"inf_sup", [](const StudyRow& row) { return cell_of(row.inf_sup); }}};
  return columns;
}

const Names<CellOfRow>& columns_of_cost() {
  static const Names<CellOfRow> columns{
      {"iterations", [](const StudyRow& row) { return Cell(std::int64_t{row.iterations}); }},
      {"seconds", [](const StudyRow& row) { return Cell(row.seconds); }}};
  return columns;
}

/// The cell of a row by its number, with nothing in it if there is no solution.
std::function<Cell(std::size_t row)> of_row(const std::vector<StudyRow>& rows, CellOfRow cell) {
  return [&rows, cell = std::move(cell)](std::size_t row) {
    return rows[row].error.empty() ? cell(rows[row]) : Cell();
  };
}

/// Gathers columns, and leaves out those in which nothing stands.
class Columns {
 public:
  explicit Columns(const std::vector<StudyRow>& rows) : rows_(rows) {}

  void add(std::string name, std::function<Cell(std::size_t row)> cell) {
    for (std::size_t row = 0; row < rows_.size(); ++row)
      if (cell(row) != Cell()) {
        all_.push_back({std::move(name), std::move(cell)});
        return;
      }
  }

  /// Columns that a row without a solution has nothing in.
  void add(const Names<CellOfRow>& columns) {
    for (const auto& [name, cell] : columns) add(std::string(name), of_row(rows_, cell));
  }

  std::vector<StudyColumn> take() { return std::move(all_); }

 private:
  const std::vector<StudyRow>& rows_;
  std::vector<StudyColumn> all_;
};

}  // namespace

Cell cell_of(const std::optional<double>& number) {
  return number ? Cell(*number) : Cell();
}

const std::vector<NamedNumber>& falling_numbers() {
  static const std::vector<NamedNumber> numbers{
      {"bound", bound_of},
      {"displacement_error", [](const StudyRow& row) { return row.errors.displacement; }},
      {"stress_error", [](const StudyRow& row) { return row.errors.stress; }},
      {"energy_norm_error", [](const StudyRow& row) { return row.errors.energy_norm; }},
      {"energy_error", [](const StudyRow& row) { return row.errors.energy; }},
      {"total_error", [](const StudyRow& row) { return row.errors.total; }}};
  return numbers;
}

namespace {

/// The quantities of a row, by which the columns are named: a row that failed has none.
const std::vector<EnclosedQuantity>& named_quantities(const std::vector<StudyRow>& rows) {
  static const std::vector<EnclosedQuantity> none;
  for (const StudyRow& row : rows)
    if (!row.quantities.empty()) return row.quantities;
  return none;
}

/// A number of the i-th quantity of a row, if it has one.
CellOfRow of_quantity(std::size_t i, double EnclosedQuantity::*number) {
  return [i, number](const StudyRow& row) {
    const bool is_known = i < row.quantities.size() && std::isfinite(row.quantities[i].*number);
    return is_known ? Cell(row.quantities[i].*number) : Cell();
  };
}

}  // namespace

std::vector<NamedNumber> widths_of_intervals(const std::vector<StudyRow>& rows) {
  std::vector<NamedNumber> widths;
  for (const EnclosedQuantity& quantity : named_quantities(rows))
    widths.push_back({quantity.name + ".width", [i = widths.size()](const StudyRow& row) {
                        const bool is_known = i < row.quantities.size() && row.quantities[i].is_bounded();
                        return is_known ? std::optional(row.quantities[i].upper - row.quantities[i].lower)
                                        : std::nullopt;
                      }});
  return widths;
}

std::vector<Scheme> schemes_of(const std::vector<StudyRow>& rows) {
  std::vector<Scheme> schemes;
  for (const StudyRow& row : rows)
    if (schemes.empty() || schemes.back() != row.scheme) schemes.push_back(row.scheme);
  return schemes;
}

std::vector<StudyColumn> study_columns(const std::vector<StudyRow>& rows) {
  Columns columns(rows);
  columns.add("scheme", [&rows](std::size_t row) {
    return Cell(std::string(name_in(scheme_names, rows[row].scheme)));
  });
  columns.add(columns_of_sizes());
  for (const auto& [name, value] : falling_numbers()) {
    columns.add(name, [&rows, &value = value](std::size_t row) {
      return rows[row].error.empty() ? cell_of(value(rows[row])) : Cell();
    });
    columns.add(name + "_rate", [&rows, &value = value](std::size_t row) {
      return cell_of(observed_rate(rows, row, value));
    });
  }
  columns.add(columns_of_bound());
  const std::vector<NamedNumber> widths = widths_of_intervals(rows);
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string& name = named_quantities(rows)[i].name;
    columns.add(name + ".estimate", of_row(rows, of_quantity(i, &EnclosedQuantity::estimate)));
    columns.add(name + ".lower", of_row(rows, of_quantity(i, &EnclosedQuantity::lower)));
    columns.add(name + ".upper", of_row(rows, of_quantity(i, &EnclosedQuantity::upper)));
    columns.add(widths[i].name + "_rate", [&rows, value = widths[i].value](std::size_t row) {
      return cell_of(observed_rate(rows, row, value));
    });
  }
  columns.add(columns_of_cost());
  columns.add("error",
              [&rows](std::size_t row) { return rows[row].error.empty() ? Cell() : Cell(rows[row].error); });
  return columns.take();
}

}  // namespace signorini::api
