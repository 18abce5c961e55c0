#include "server/handlers/batch_results.hpp"

#include <algorithm>

#include "server/handlers/documents.hpp"
#include "server/handlers/find_job.hpp"
#include "server/http/error.hpp"

namespace signorini::server {
namespace {

/// A JSON text in one line: what breaks lines stands between its values only, as in the problem of a client.
bool put_in_line(std::string_view piece, const PieceSink& sink) {
  std::string line(piece);
  std::ranges::replace_if(
      line, [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return sink(line);
}

}  // namespace

bool BatchResults::write(const PieceSink& sink) {
  watch_ = service_.scheduler.watch(batch_);
  const BatchEnds ends = service_.store.ends_of_batch(batch_, latest_);
  for (const std::string& id : ends.jobs) {
    if (told_.contains(id)) continue;
    std::optional<Job> job = service_.store.find(id);
    if (job && !write_one(std::move(*job), sink)) return false;
    told_.insert(id);
  }
  latest_ = ends.latest;
  complete_ = ends.all;
  return true;
}

std::shared_ptr<void> BatchResults::subscribe(std::function<void()> ready) {
  return watch_->tell(std::move(ready));
}

/// True too if it was removed meanwhile.
bool BatchResults::write_one(Job job, const PieceSink& sink) const {
  JobWithResult about{job, {}};
  if (job.verdict.summary) {
    try {
      about = summary_alone_ ? with_summary(std::move(job)) : with_result(service_, std::move(job));
    } catch (const HttpError& error) {
      // What is stored may turn out to be damaged when it is read.
      if (error.status == 503) throw;
      std::optional<Job> now = service_.store.find(about.job.id);
      if (!now) return true;
      about = {std::move(*now), {}};
    }
  }
  const bool in_lines = format_ == api::Format::json;
  const PieceSink piece_sink =
      in_lines ? [&](std::string_view piece) { return put_in_line(piece, sink); } : sink;
  const bool written = api::write_document(format_, piece_sink, [&](api::DocumentWriter& out) {
    const auto& [of, result] = about;
    if (!result.solution) return write_status(out, of, nullptr);
    api::ResultFields fields = fields_;
    if (result.solution->components == 1) fields.principal = fields.von_mises = false;
    write_result_of(out, about, fields);
  });
  return written && (!in_lines || sink("\n"));
}

}  // namespace signorini::server
