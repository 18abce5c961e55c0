#include "server/handlers/find_job.hpp"

#include "server/handlers/documents.hpp"

namespace signorini::server {
namespace {

std::string no_result_yet(const Job& job) {
  return "The solve is " + std::string(name(job.status)) + "; its result is there once it has ended. GET " +
         link_to(job.id) + " shows how far it is.";
}

HttpError without_result(const Job& job) {
  if (!has_ended(job.status)) return {409, {"not-ended", "The solve has not ended", no_result_yet(job)}};
  const std::string why = job.verdict.error ? " " + job.verdict.error->detail : "";
  return {410,
          {"no-result", "The solve has no result",
           "It ended as " + std::string(name(job.status)) + " before there was any." + why}};
}

}  // namespace

const std::string& id_of(const Request& request) {
  return request.path_parameters.at("id");
}

HttpError unknown_solve() {
  return {404,
          {"unknown-solve", "Unknown solve",
           "There is no solve with this id that this client may see; it may have been deleted, or dropped to "
           "keep "
           "within --keep-bytes or --keep-seconds."}};
}

Job find_job(Service& service, const Request& request) {
  std::optional<Job> job = service.store.find(id_of(request));
  if (!job || !request.identity.may_see_those_of(job->owner)) throw unknown_solve();
  return std::move(*job);
}

Job find_solved(Service& service, const Request& request) {
  Job job = find_job(service, request);
  if (!job.verdict.summary) throw without_result(job);
  return job;
}

JobWithResult find_job_with_result(Service& service, const Request& request) {
  return with_result(service, find_solved(service, request));
}

JobWithResult with_summary(Job job) {
  Solution solution;
  solution.summary = *job.verdict.summary;
  JobResult result{std::make_shared<const std::string>(),
                   std::make_shared<const Solution>(std::move(solution)), nullptr};
  return {std::move(job), std::move(result)};
}

JobWithResult with_result(Service& service, Job job) {
  std::optional<JobResult> result = service.results.get(job.id);
  if (!result) throw unknown_solve();
  // What is stored may turn out to be damaged when it is read.
  if (job.verdict.summary && !result->solution)
    throw without_result(service.store.find(job.id).value_or(job));
  return {std::move(job), std::move(*result)};
}

void write_result_of(api::DocumentWriter& out, const JobWithResult& solved, const api::ResultFields& fields) {
  const auto& [job, result] = solved;
  const std::string error = error_to_json(job.verdict.error);
  api::write_result(out, {job.id, name(job.status), *result.problem, error}, *result.solution, fields);
}

}  // namespace signorini::server
