#include "api/result/result_document.hpp"

#include <algorithm>
#include <cmath>

namespace signorini::api {

void write_result(DocumentWriter& out, const ResultHead& head, const Solution& solution,
                  const ResultFields& fields) {
  fields.require_available(solution.components);
  out.begin_object();
  if (!head.id.empty()) out.member("id", head.id);
  out.member("status", head.status);
  if (!head.error_json.empty()) out.key("error").json(head.error_json);
  if (fields.problem) out.key("problem").json(head.problem_json);
  write_summary(out.key("summary"), solution.summary);
  if (fields.mesh) write_mesh(out.key("mesh"), *solution.mesh);
  if (fields.displacement) write_displacement(out.key("displacement"), solution);
  if (fields.stress) write_stress(out.key("stress"), solution);
  if (fields.principal) write_principal(out.key("principal"), solution);
  if (fields.von_mises) write_von_mises(out.key("von_mises"), solution);
  if (fields.error_squares && solution.error_squares.size() > 0)
    write_error_squares(out.key("error_squares"), solution);
  if (fields.levels && !solution.levels.empty()) write_level_fields(out.key("levels"), solution.levels);
  if (fields.quantities && !solution.summary.quantities.empty())
    write_quantities(out.key("quantities"), solution.summary.quantities);
  if (fields.contact) write_contact(out.key("contact"), solution.contact);
  if (fields.history) write_history(out.key("history"), solution.history);
  if (fields.sweep && !solution.sweep.empty()) write_sweep(out.key("sweep"), solution.sweep, fields.contact);
  if (fields.study && !solution.study.empty()) write_study(out.key("study"), solution.study);
  out.end_object();
}

void write_estimates(DocumentWriter& out, const Estimates& foreseen, const std::vector<std::string>& left) {
  const auto& [problem, runs] = foreseen;
  double seconds = problem.seconds;
  for (const Estimate& run : runs) seconds += run.seconds;
  out.begin_object().member("valid", true).member("triangles", problem.triangles);
  write_unknowns(out.key("unknowns"), problem.unknowns);
  out.member("system", problem.system);
  out.key("estimated").begin_object();
  out.member("memory_bytes", std::round(foreseen.memory_bytes())).member("seconds", seconds).end_object();
  if (!runs.empty()) out.member("study_runs", runs.size());
  if (!left.empty()) out.key("notes").texts(left);
  out.end_object();
}

}  // namespace signorini::api
