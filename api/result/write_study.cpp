#include "api/names.hpp"
#include "api/result/result_members.hpp"
#include "api/result/study_columns.hpp"

namespace signorini::api {
namespace {

/// Writes a member unless there is nothing in the cell.
struct WriteCell {
  DocumentWriter& out;
  const std::string& name;

  void operator()(std::monostate) const {}
  template <typename Content>
  void operator()(const Content& content) const {
    out.member(name, content);
  }
};

void write_fitted_rates(DocumentWriter& out, const std::vector<StudyRow>& rows, Scheme scheme) {
  out.begin_object().member("scheme", name_in(scheme_names, scheme));
  for (const auto& [name, value] : falling_numbers())
    if (const auto rate = fitted_rate(rows, scheme, value)) out.member(name, *rate);
  for (const auto& [name, value] : widths_of_intervals(rows))
    if (const auto rate = fitted_rate(rows, scheme, value)) out.member(name, *rate);
  out.end_object();
}

}  // namespace

void write_study(DocumentWriter& out, const std::vector<StudyRow>& rows) {
  const std::vector<StudyColumn> columns = study_columns(rows);
  out.begin_object().key("rows").begin_array();
  for (std::size_t row = 0; row < rows.size(); ++row) {
    out.begin_object();
    for (const StudyColumn& column : columns) std::visit(WriteCell{out, column.name}, column.cell(row));
    out.end_object();
  }
  out.end_array().key("rates").begin_array();
  for (const Scheme scheme : schemes_of(rows)) write_fitted_rates(out, rows, scheme);
  out.end_array().end_object();
}

}  // namespace signorini::api
