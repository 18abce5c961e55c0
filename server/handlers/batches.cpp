#include "server/handlers/batches.hpp"

#include <spdlog/spdlog.h>

#include "server/handlers/batch_intake.hpp"
#include "server/handlers/batch_results.hpp"
#include "server/handlers/dismiss.hpp"
#include "server/handlers/document_response.hpp"
#include "server/handlers/documents.hpp"
#include "server/handlers/events.hpp"
#include "server/handlers/fields.hpp"
#include "server/handlers/find_job.hpp"
#include "server/handlers/submission.hpp"
#include "server/http/conditions.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

HttpError unknown_batch() {
  return {
      404,
      {"unknown-batch", "Unknown batch",
       "There is no batch with this id that this client may see; it is gone with the last of its solves."}};
}

/// The batch of the path. Throws HttpError 404, also for a batch of somebody else.
Batch find_batch(Service& service, const Request& request) {
  std::optional<Batch> batch = service.store.find_batch(id_of(request));
  if (!batch || !request.identity.may_see_those_of(batch->owner)) throw unknown_batch();
  return std::move(*batch);
}

void write_links(api::DocumentWriter& out, const std::string& id) {
  const std::string self = link_to_batch(id);
  out.begin_object().member("self", self).member("results", self + "/results").end_object();
}

/// How many of its solves are where; those that are no longer kept are `deleted`.
void write_counts(api::DocumentWriter& out, const Batch& batch, const JobCounts& counts) {
  std::size_t there = 0;
  out.begin_object();
  for (const JobStatus status : all_statuses) {
    const auto found = counts.find(status);
    const std::size_t count = found == counts.end() ? 0 : found->second;
    out.member(name(status), count);
    there += count;
  }
  out.member("deleted", batch.jobs.size() - there).end_object();
}

}  // namespace

Response post_batch(Service& service, const Request& request) {
  allow_only(request.query, {});
  const std::optional<std::string> key = idempotency_key(request);
  require_conditions(request);
  NewBatch taken = take_in_batch(service, request);
  taken.key = key;
  const Batch batch = submit(service, request, std::move(taken));
  Response response = document_response(request, 202, [batch](api::DocumentWriter& out) {
    out.begin_object().member("id", batch.id).key("solves").texts(batch.jobs);
    write_links(out.key("links"), batch.id);
    out.end_object();
  });
  response.headers.emplace_back("Location", link_to_batch(batch.id));
  return response;
}

Response get_batch(Service& service, const Request& request) {
  allow_only(request.query, {});
  const Batch batch = find_batch(service, request);
  const JobCounts counts = service.store.count_of_batch(batch.id);
  return document_response(request, 200, [batch, counts](api::DocumentWriter& out) {
    out.begin_object().member("id", batch.id).member("title", batch.title);
    out.key("tags").texts(batch.tags);
    out.member("created_at", iso8601(batch.created)).member("count", batch.jobs.size());
    write_counts(out.key("counts"), batch, counts);
    out.key("solves").texts(batch.jobs);
    write_links(out.key("links"), batch.id);
    out.end_object();
  });
}

Response get_batch_results(Service& service, const Request& request) {
  allow_only(request.query, {"fields"});
  const api::ResultFields fields = fields_of(request);
  const Batch batch = find_batch(service, request);
  Response response = Response::empty(200);
  response.content_type = request.reply_type;
  // A proxy must not collect them.
  response.headers.emplace_back("X-Accel-Buffering", "no");
  if (request.method == "HEAD") return response;
  std::shared_ptr<void> place = service.events.open_streams().try_acquire();
  if (!place) throw too_many_subscribers(service.events.open_streams().count());
  response.in_the_way = [&results = service.results] { return results.are_awaited(); };
  const api::Format format = request.reply_type == ndjson_media_type ? api::Format::json : api::Format::cbor;
  response.parts = std::make_shared<BatchResults>(service, batch.id, format, fields,
                                                  picks_summary_alone(request.query), std::move(place));
  return response;
}

Response delete_batch(Service& service, const Request& request) {
  allow_only(request.query, {});
  const Batch batch = find_batch(service, request);
  const LogField field("batch", batch.id);
  require_conditions(request);
  return dismissed_response(request, dismiss(service, batch.jobs));
}

}  // namespace signorini::server
