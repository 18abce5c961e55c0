#include "server/handlers/solves.hpp"

#include <spdlog/spdlog.h>

#include "server/handlers/document_response.hpp"
#include "server/handlers/documents.hpp"
#include "server/handlers/fields.hpp"
#include "server/handlers/find_job.hpp"
#include "server/handlers/intake.hpp"
#include "server/handlers/submission.hpp"
#include "server/handlers/wait.hpp"
#include "server/http/conditions.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

/// A document about the job, which lives as long as it is written: `write(out, about)`.
template <typename Write>
Response job_response(Service& service, const Request& request, int status, JobWithResult about,
                      const Write& write) {
  const auto shared = std::make_shared<const JobWithResult>(std::move(about));
  Response response =
      document_response(request, status, [shared, write](api::DocumentWriter& out) { write(out, *shared); });
  response.job = shared->job.id;
  response.in_the_way = [&results = service.results] { return results.are_awaited(); };
  return response;
}

Response status_response(Service& service, const Request& request, int status, Job job) {
  const LiveSolves lives = service.scheduler.live(std::span(&job, 1));
  return job_response(service, request, status, {std::move(job), {}},
                      [live = lives.empty() ? nullptr : lives.begin()->second](api::DocumentWriter& out,
                                                                               const JobWithResult& about) {
                        write_status(out, about.job, live.get());
                      });
}

Response result_response(Service& service, const Request& request, JobWithResult ended,
                         const api::ResultFields& fields) {
  return job_response(service, request, 200, std::move(ended),
                      [fields](api::DocumentWriter& out, const JobWithResult& solved) {
                        write_result_of(out, solved, fields);
                      });
}

/// The reply to a client whose solve was taken in; `waited` if it wants the result, should it be there.
Response answer(Service& service, const Request& request, std::optional<Job> job, bool waited,
                const api::ResultFields& fields) {
  if (!job) {
    throw HttpError(410, {"deleted", "The solve was deleted", "It was deleted before it could be answered."});
  }
  const std::string location = link_to(job->id);
  const bool ended = waited && has_ended(job->status);
  Response response =
      ended && job->verdict.summary
          ? result_response(service, request,
                            picks_summary_alone(request.query) ? with_summary(std::move(*job))
                                                               : with_result(service, std::move(*job)),
                            fields)
          : status_response(service, request, ended ? 200 : 202, std::move(*job));
  response.headers.emplace_back("Location", location);
  return response;
}

/// Answers when the solve has ended or the time is over. A client that leaves before takes its solve along if
/// it said so.
Response answer_later(Service& service, const Request& request, const std::string& id, const Wait& wait,
                      const api::ResultFields& fields, std::shared_ptr<void> place) {
  using Clock = std::chrono::steady_clock;
  const auto watch = service.scheduler.watch(id);
  const auto promise = std::make_shared<LaterReply>();
  promise->job = id;
  promise->until = Clock::now() + std::chrono::duration_cast<Clock::duration>(wait.time);
  promise->place = std::move(place);
  promise->subscribe = [watch](std::function<void()> ready) { return watch->tell(std::move(ready)); };
  promise->make = [&service, &request, id, wait, fields] {
    Response response = answer(service, request, service.store.find(id), true, fields);
    if (wait.preferred) response.headers.emplace_back("Preference-Applied", *wait.preferred);
    return response;
  };
  promise->leave = [&service, id, cancel = wait.or_cancel] {
    if (cancel) service.scheduler.cancel(id);
  };
  // Asked after it is watched: if it had ended before, nobody would tell.
  const std::optional<Job> job = service.store.find(id);
  if (!job || has_ended(job->status)) promise->until = Clock::now();
  Response response;
  response.later = promise;
  return response;
}

/// Takes a problem in by one of the functions of intake.hpp, queues it and answers.
Response accept(Service& service, const Request& request,
                Intake (*take)(Service& service, const Request& request)) {
  allow_only(request.query, {"wait", "cancel", "fields"});
  const api::ResultFields fields = fields_of(request);
  const std::optional<Wait> wait = wait_of(request);
  const std::optional<std::string> key = idempotency_key(request);
  require_conditions(request);
  Intake intake = take(service, request);
  require_available(fields, components(intake.request.problem.material));
  NewJob job = new_job(service, request, std::move(intake));
  job.key = key;
  const std::string id = submit(service, request, std::move(job));

  // Where too many wait, nobody is refused for it: the status document says how to go on.
  std::shared_ptr<void> place = wait ? service.waits.try_acquire() : nullptr;
  if (!place) return answer(service, request, service.store.find(id), false, fields);
  return answer_later(service, request, id, *wait, fields, std::move(place));
}

}  // namespace

Response post_solve(Service& service, const Request& request) {
  return accept(service, request, take_in);
}

Response post_study(Service& service, const Request& request) {
  return accept(service, request, take_in_study);
}

Response get_solve(Service& service, const Request& request) {
  allow_only(request.query, {});
  return status_response(service, request, 200, find_job(service, request));
}

Response get_result(Service& service, const Request& request) {
  allow_only(request.query, {"fields"});
  const api::ResultFields fields = fields_of(request);
  if (picks_summary_alone(request.query))
    return result_response(service, request, with_summary(find_solved(service, request)), fields);
  JobWithResult ended = find_job_with_result(service, request);
  require_available(fields, ended.result.solution->components);
  return result_response(service, request, std::move(ended), fields);
}

Response get_history(Service& service, const Request& request) {
  allow_only(request.query, {});
  // Asked before the job: a solve that ends in between is then found as ended, with its whole history.
  const auto live = service.scheduler.live(id_of(request));
  Job job = find_job(service, request);
  JobWithResult iterated =
      has_ended(job.status) ? with_result(service, std::move(job)) : JobWithResult{std::move(job), {}};
  return job_response(service, request, 200, std::move(iterated),
                      [live](api::DocumentWriter& out, const JobWithResult& about) {
                        write_history_so_far(out, about, live.get());
                      });
}

Response delete_solve(Service& service, const Request& request) {
  allow_only(request.query, {});
  Response response = Response::empty(204);
  response.job = id_of(request);
  const LogField job("job", find_job(service, request).id);
  require_conditions(request);
  switch (service.scheduler.dismiss(id_of(request))) {
    case Dismissal::unknown:
      throw unknown_solve();
    case Dismissal::removed:
      spdlog::info("deleted");
      return response;
    case Dismissal::cancelled:
    case Dismissal::cancelling:
      return status_response(service, request, 202, find_job(service, request));
  }
  return response;
}

}  // namespace signorini::server
