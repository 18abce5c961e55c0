#include "api/result/history_columns.hpp"
#include "api/result/result_members.hpp"

namespace signorini::api {

void write_history(DocumentWriter& out, std::size_t rows, const HistoryRow& row) {
  out.begin_object();
  for_each_history_column(rows > 0 ? &row(0) : nullptr, [&](std::string_view name, const auto& entry) {
    out.key(name).rows({rows}, [&](std::size_t i) { return entry(row(i)); });
  });
  out.end_object();
}

void write_history(DocumentWriter& out, const std::vector<Iteration>& history) {
  write_history(out, history.size(), [&](std::size_t i) -> const Iteration& { return history[i]; });
}

void write_iteration(DocumentWriter& out, const Iteration& iteration) {
  out.begin_object();
  for_each_history_column(
      &iteration, [&](std::string_view name, const auto& entry) { out.member(name, entry(iteration)); });
  out.end_object();
}

}  // namespace signorini::api
