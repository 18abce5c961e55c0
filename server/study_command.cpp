#include "server/study_command.hpp"

#include "api/result/csv.hpp"
#include "api/result/result_document.hpp"
#include "api/result/study_table.hpp"
#include "server/local_solve.hpp"

namespace signorini::server {
namespace {

bool write(const Ending& ending, const std::string& format, const api::Sink& sink) {
  const std::vector<StudyRow>& rows = ending.solution->study;
  if (format == "table") return api::write_study_table(rows, sink);
  if (format == "csv") return api::write_study_csv(rows, sink);
  return api::write_document(api::Format::json, sink, [&](api::DocumentWriter& out) {
    api::write_result(out, {{}, name(ending.status), {}}, *ending.solution,
                      api::ResultFields::parse("study"));
  });
}

}  // namespace

int run_study_command(const StudyConfig& config) {
  return run_locally([&] {
    api::Request request = parse_input(read_input(config.file));
    request.settings.factorization = config.factorization;
    if (!request.study)
      throw BadInput{{"no-study", "The problem has no study",
                      "It needs the member `study`, which gives the meshes and schemes to solve it by."}};
    return solve_and_write(request, [&](const Ending& ending, const api::Sink& sink) {
      return write(ending, config.format, sink);
    });
  });
}

}  // namespace signorini::server
