#include "server/handlers/downloads.hpp"

#include "api/csv.hpp"
#include "api/vtu.hpp"
#include "server/handlers/find_job.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

constexpr const char* csv = "text/csv; charset=utf-8";

/// The result of the job as a file that is written while it is sent; `suffix` follows the id in its name.
template <typename Write>
Response download(Service& service, const Request& request, const char* content_type,
                  const std::string& suffix, const Write& write) {
  allow_only(request.query, {});
  const auto [job, result] = find_job_with_result(service, request);
  Response response = Response::empty(200);
  response.job = job.id;
  response.content_type = content_type;
  response.headers.emplace_back("Content-Disposition", "attachment; filename=\"" + job.id + suffix + "\"");
  response.in_the_way = [&results = service.results] { return results.are_awaited(); };
  response.write_body = [solution = result.solution, write](const PieceSink& sink) {
    return write(*solution, sink);
  };
  return response;
}

}  // namespace

Response get_result_vtu(Service& service, const Request& request) {
  return download(service, request, vtu_media_type, ".vtu", api::write_vtu);
}

Response get_history_csv(Service& service, const Request& request) {
  return download(service, request, csv, "-history.csv", [](const Solution& solution, const PieceSink& sink) {
    return api::write_history_csv(solution.history, sink);
  });
}

Response get_contact_csv(Service& service, const Request& request) {
  return download(service, request, csv, "-contact.csv", [](const Solution& solution, const PieceSink& sink) {
    return api::write_contact_csv(solution.contact, sink);
  });
}

Response get_study_csv(Service& service, const Request& request) {
  if (find_job_with_result(service, request).result.solution->study.empty())
    throw HttpError(404, {"no-study", "The solve has no study",
                          "Its problem has no `study`; POST /v1/studies takes problems that have one."});
  return download(service, request, csv, "-study.csv", [](const Solution& solution, const PieceSink& sink) {
    return api::write_study_csv(solution.study, sink);
  });
}

}  // namespace signorini::server
