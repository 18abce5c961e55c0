#include "server/handlers/submission.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/handlers/documents.hpp"
#include "server/http/error.hpp"
#include "server/http/thread_pool.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

using Header = std::pair<std::string, std::string>;

HttpError unavailable(const std::string& kind, const std::string& title, const std::string& detail,
                      const char* retry_after_seconds) {
  return {503, {kind, title, detail}, {Header{"Retry-After", retry_after_seconds}}};
}

HttpError key_reused(const std::string& key, const KeyReused& reused) {
  return {422,
          {"idempotency-key-reused", "The idempotency key belongs to another problem",
           "The Idempotency-Key `" + key + "` came with another body before; " +
               (reused.of_batch ? "its batch is " + link_to_batch(reused.id)
                                : "its solve is " + link_to(reused.id)) +
               ". Take a new key for a new problem."}};
}

HttpError no_place(const QueueFull& full, std::size_t jobs, const std::string& name) {
  const std::string limit = std::to_string(full.limit);
  if (!full.share)
    return unavailable("queue-full", "The queue is full",
                       limit + (full.limit == 1 ? " request is" : " requests are") +
                           " waiting, which is the limit (--queue-limit).",
                       "5");
  const std::string of_name = " solves of `" + name + "`", reason = "the limit of this name (--token-file).";
  if (jobs > full.limit)
    return {413,
            {"batch-too-long", "The batch is too long",
             "It has " + std::to_string(jobs) + " problems; " + limit + of_name + " may wait, which is " +
                 reason + " Split the batch."}};
  const std::string detail = jobs == 1
                                 ? limit + of_name + " are waiting, which is " + reason
                                 : "The " + std::to_string(jobs) + " problems of the batch and the" +
                                       of_name + " that are waiting are more than " + limit + ", " + reason;
  return {429, {"share-used-up", "The share of the queue is used up", detail}, {{"Retry-After", "5"}}};
}

/// What `queue` returns, its complaints as replies. Others work while the disk does.
template <typename Queue>
auto queued(const Request& request, const std::optional<std::string>& key, std::size_t jobs,
            const Queue& queue) {
  try {
    const ThreadPool::Waiting rest;
    return queue();
  } catch (const QueueFull& full) {
    throw no_place(full, jobs, request.identity.name);
  } catch (const MemoryFull& full) {
    throw unavailable("memory-full", "The memory is spoken for", full.what(), "10");
  } catch (const Stopping&) {
    throw unavailable("stopping", "The service is stopping", "It takes no more solves.", "10");
  } catch (const KeyReused& reused) {
    throw key_reused(*key, reused);
  }
}

}  // namespace

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

NewJob new_job(Service& service, const Request& request, Intake intake) {
  NewJob job;
  job.id = service.ids.next();
  job.title = std::move(intake.request.title);
  job.tags = std::move(intake.request.tags);
  job.created = std::chrono::system_clock::now();
  job.problem = std::make_shared<const std::string>(std::move(intake.text));
  job.predicted_memory = intake.memory();
  if (request.trace) job.trace = request.trace->id;
  job.owner = request.identity.name;
  job.operator_mark = operator_mark(operator_key_of(job.owner, intake.request.problem.operator_key));
  job.share = request.identity.share;
  return job;
}

std::string submit(Service& service, const Request& request, NewJob job) {
  const std::optional<std::string> key = job.key;
  const std::string new_id = job.id;
  std::string id = queued(request, key, 1, [&] { return service.scheduler.submit(std::move(job)); });
  const LogField field("job", id);
  if (id == new_id) spdlog::info("accepted");
  return id;
}

Batch submit(Service& service, const Request& request, NewBatch batch) {
  const std::optional<std::string> key = batch.key;
  const std::string new_id = batch.batch.id;
  const std::size_t jobs = batch.jobs.size();
  Batch accepted = queued(request, key, jobs, [&] { return service.scheduler.submit(std::move(batch)); });
  const LogField field("batch", accepted.id);
  if (accepted.id == new_id) spdlog::info("accepted jobs={}", jobs);
  return accepted;
}

}  // namespace signorini::server
