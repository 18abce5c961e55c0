#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "run/study.hpp"

namespace signorini::api {

/// What stands in one place of a table; nothing where a row has no such number.
using Cell = std::variant<std::monostate, std::int64_t, double, bool, std::string>;

/// The number, or nothing.
Cell cell_of(const std::optional<double>& number);

struct StudyColumn {
  std::string name;
  std::function<Cell(std::size_t row)> cell;
};

/// The columns of a study's table in their order, without those that no row has anything in. Refers to the
/// rows.
std::vector<StudyColumn> study_columns(const std::vector<StudyRow>& rows);

/// The numbers that have a rate: the bound and the errors, by the names of their columns.
struct NamedNumber {
  std::string name;
  RowNumber value;
};
const std::vector<NamedNumber>& falling_numbers();

/// `NAME.width` of each quantity that the problem asks for: the widths of their intervals.
std::vector<NamedNumber> widths_of_intervals(const std::vector<StudyRow>& rows);

/// The schemes of the rows in their order.
std::vector<Scheme> schemes_of(const std::vector<StudyRow>& rows);

}  // namespace signorini::api
