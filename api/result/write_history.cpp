#include "api/result/history_columns.hpp"
#include "api/result/result_members.hpp"

namespace signorini::api {

void write_history(DocumentWriter& out, const std::vector<Iteration>& history) {
  out.begin_object();
  for_each_history_column(history, [&](std::string_view name, const auto& entry) {
    out.key(name).rows({history.size()}, [&](std::size_t i) { return entry(history[i]); });
  });
  out.end_object();
}

void write_iteration(DocumentWriter& out, const Iteration& iteration) {
  out.begin_object();
  for_each_history_column(
      {iteration}, [&](std::string_view name, const auto& entry) { out.member(name, entry(iteration)); });
  out.end_object();
}

}  // namespace signorini::api
