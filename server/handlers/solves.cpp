#include "server/handlers/solves.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "api/result_document.hpp"
#include "server/handlers/document_response.hpp"
#include "server/handlers/documents.hpp"
#include "server/handlers/find_job.hpp"
#include "server/handlers/intake.hpp"
#include "server/handlers/wait.hpp"
#include "server/http/crew.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

using Header = std::pair<std::string, std::string>;

HttpError unavailable(const std::string& kind, const std::string& title, const std::string& detail,
                      const char* retry_after_seconds) {
  return {503, {kind, title, detail}, {Header{"Retry-After", retry_after_seconds}}};
}

/// What `use` returns, its complaint about the fields turned into 400.
template <typename Use>
auto with_fields(const Use& use) {
  try {
    return use();
  } catch (const InvalidProblem& invalid) {
    throw bad_parameter("fields", invalid.faults().front().detail);
  }
}

api::ResultFields fields_of(const Request& request) {
  return with_fields(
      [&] { return api::ResultFields::parse(parameter(request.query, "fields").value_or("")); });
}

/// Before a reply is begun: no status could follow then.
void require_available(const api::ResultFields& fields, int components) {
  with_fields([&] { fields.require_available(components); });
}

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
  const auto live = service.scheduler.live(job.id);
  return job_response(service, request, status, {std::move(job), {}},
                      [live](api::DocumentWriter& out, const JobWithResult& about) {
                        write_status(out, about.job, live.get());
                      });
}

Response result_response(Service& service, const Request& request, JobWithResult ended,
                         const api::ResultFields& fields) {
  return job_response(service, request, 200, std::move(ended),
                      [fields](api::DocumentWriter& out, const JobWithResult& solved) {
                        const auto& [job, result] = solved;
                        const std::string error = error_to_json(job.verdict.error);
                        const api::ResultHead head{job.id, name(job.status), *result.problem, error};
                        api::write_result(out, head, *result.solution, fields);
                      });
}

JobWithResult with_summary(Job job) {
  Solution solution;
  solution.summary = *job.verdict.summary;
  JobResult result{std::make_shared<const std::string>(),
                   std::make_shared<const Solution>(std::move(solution)), nullptr};
  return {std::move(job), std::move(result)};
}

HttpError key_reused(const std::string& key, const KeyReused& reused) {
  return {422,
          {"idempotency-key-reused", "The idempotency key belongs to another problem",
           "The Idempotency-Key `" + key + "` came with another body before; its solve is " +
               link_to(reused.job) + ". Take a new key for a new problem."}};
}

HttpError share_used_up(const std::string& name, std::size_t limit) {
  return {
      429,
      {"share-used-up", "The share of the queue is used up",
       std::to_string(limit) + " solves of `" + name + "` are waiting, which is its limit (--token-file)."},
      {{"Retry-After", "5"}}};
}

/// Others work while the disk does.
std::string queue(Service& service, NewJob job) {
  const Crew::Rest rest;
  return service.scheduler.submit(std::move(job));
}

/// Queues the problem and returns the id of its job, or of the earlier one with the same key and problem.
std::string submit(Service& service, const Request& request, Intake intake,
                   const std::optional<std::string>& key) {
  NewJob job;
  job.id = service.ids.next();
  job.title = std::move(intake.request.title);
  job.tags = std::move(intake.request.tags);
  job.created = std::chrono::system_clock::now();
  job.problem = std::make_shared<const std::string>(std::move(intake.text));
  job.key = key;
  job.predicted_memory = intake.memory();
  if (request.trace) job.trace = request.trace->id;
  job.owner = request.identity.name;
  job.share = request.identity.share;
  const std::string new_id = job.id;
  try {
    std::string id = queue(service, std::move(job));
    const LogField field("job", id);
    if (id == new_id) spdlog::info("accepted");
    return id;
  } catch (const QueueFull& full) {
    if (full.share) throw share_used_up(request.identity.name, full.limit);
    throw unavailable("queue-full", "The queue is full",
                      std::to_string(full.limit) + " solves are waiting, which is the limit (--queue-limit).",
                      "5");
  } catch (const MemoryFull& full) {
    throw unavailable("memory-full", "The memory is spoken for", full.what(), "10");
  } catch (const Stopping&) {
    throw unavailable("stopping", "The service is stopping", "It takes no more solves.", "10");
  } catch (const KeyReused& reused) {
    throw key_reused(*key, reused);
  }
}

/// The key by which a client may send its request again without solving the problem twice. Throws HttpError
/// 400.
std::optional<std::string> idempotency_key(const Request& request) {
  constexpr std::size_t longest = 255;
  const std::optional<std::string> key = request.header("Idempotency-Key");
  const bool visible =
      !key || std::all_of(key->begin(), key->end(), [](char c) { return c > ' ' && c <= '~'; });
  if (key && (key->empty() || key->size() > longest || !visible)) {
    throw HttpError(400, {"bad-idempotency-key", "Bad Idempotency-Key",
                          "An Idempotency-Key is one of 1 to 255 visible ASCII characters, such as a UUID."});
  }
  return key;
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
  Intake intake = take(service, request);
  require_available(fields, components(intake.request.problem.material));
  const std::string id = submit(service, request, std::move(intake), key);

  // Where too many wait, nobody is refused for it: the status document says how to go on.
  std::shared_ptr<void> place = wait ? service.waits.take() : nullptr;
  if (!place) return answer(service, request, service.store.find(id), false, fields);
  return answer_later(service, request, id, *wait, fields, std::move(place));
}

/// A solve has no ETag, so that no condition on one holds (RFC 9110, 13.1.1). Throws HttpError 412.
void require_match(const Request& request) {
  const std::optional<std::string> condition = request.header("If-Match");
  if (!condition || *condition == "*") return;
  throw HttpError(412, {"precondition-failed", "Precondition failed",
                        "A solve has no ETag, so that only `If-Match: *` holds; nothing was changed."});
}

}  // namespace

bool picks_summary_alone(const Query& query) {
  return parameter(query, "fields") == "summary";
}

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
  if (!iterated.result.history && live) {
    iterated.result.history = std::make_shared<const std::vector<Iteration>>(live->history());
  }
  return job_response(
      service, request, 200, std::move(iterated), [](api::DocumentWriter& out, const JobWithResult& about) {
        const auto& history = about.result.history;
        write_history_so_far(out, about.job.status, history ? *history : std::vector<Iteration>());
      });
}

Response delete_solve(Service& service, const Request& request) {
  allow_only(request.query, {});
  Response response = Response::empty(204);
  response.job = id_of(request);
  const LogField job("job", find_job(service, request).id);
  require_match(request);
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
