#include "server/handlers/downloads.hpp"

#include "api/picture/picture.hpp"
#include "api/problem/problem_json.hpp"
#include "api/result/csv.hpp"
#include "api/result/vtu.hpp"
#include "server/handlers/find_job.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

constexpr const char* csv = "text/csv; charset=utf-8";

/// A file that is written from the result of the job while it is sent.
template <typename Write>
Response file_of(Service& service, const JobWithResult& about, const char* content_type, const Write& write) {
  Response response = Response::empty(200);
  response.job = about.job.id;
  response.content_type = content_type;
  response.in_the_way = [&results = service.results] { return results.are_awaited(); };
  response.write_body = [solution = about.result.solution, write](const PieceSink& sink) {
    return write(*solution, sink);
  };
  return response;
}

/// Such a file to be kept; `suffix` follows the id in its name.
template <typename Write>
Response download(Service& service, const Request& request, const char* content_type,
                  const std::string& suffix, const Write& write) {
  allow_only(request.query, {});
  const JobWithResult about = find_job_with_result(service, request);
  Response response = file_of(service, about, content_type, write);
  response.headers.emplace_back("Content-Disposition",
                                "attachment; filename=\"" + about.job.id + suffix + "\"");
  return response;
}

/// What `use` returns, its complaint about the picture turned into 400.
template <typename Use>
auto with_picture(const Use& use) {
  try {
    return use();
  } catch (const InvalidProblem& invalid) {
    const Fault& fault = invalid.faults().front();
    throw bad_parameter(fault.where.substr(1), fault.detail);
  }
}

}  // namespace

Response get_result_vtu(Service& service, const Request& request) {
  return download(service, request, vtu_media_type, ".vtu", api::write_vtu);
}

Response get_picture(Service& service, const Request& request) {
  allow_only(request.query, {"field", "deformed"});
  api::Picture picture;
  picture.field =
      with_picture([&] { return api::Picture::field_named(parameter(request.query, "field").value_or("")); });
  picture.deformed = number_parameter(request.query, "deformed", 0, api::Picture::most_deformed);
  const JobWithResult about = find_job_with_result(service, request);
  with_picture([&] { picture.require_available(*about.result.solution); });
  if (about.result.solution->components == 2)
    picture.contacts = api::Picture::contacts_of(api::parse_request(*about.result.problem).problem);
  return file_of(service, about, svg_media_type, [picture](const Solution& solution, const PieceSink& sink) {
    return api::write_picture(solution, picture, sink);
  });
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

Response get_quantities_csv(Service& service, const Request& request) {
  return download(service, request, csv, "-quantities.csv",
                  [](const Solution& solution, const PieceSink& sink) {
                    return api::write_quantities_csv(solution.summary.quantities, sink);
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
