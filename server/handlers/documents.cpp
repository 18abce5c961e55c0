#include "server/handlers/documents.hpp"

#include "api/result/result_members.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

using api::DocumentWriter;

/// The value, or null.
template <typename Value>
void member(DocumentWriter& out, std::string_view name, const std::optional<Value>& value) {
  out.key(name);
  if (value) {
    out.value(*value);
  } else {
    out.null();
  }
}

std::optional<std::string> text_of(const std::optional<Time>& time) {
  return time ? std::optional(iso8601(*time)) : std::nullopt;
}

Progress progress_of(const Job& job, const LiveSolve* live) {
  // A worker announces the end of its solve after the store has it.
  if (live != nullptr && !has_ended(job.status)) return live->progress();
  Progress progress;
  if (const auto& last = job.verdict.last_iteration) {
    progress.iteration = last->number;
    progress.residual = residual(*last);
  }
  return progress;
}

void write_done(DocumentWriter& out, std::size_t done, std::size_t count) {
  out.begin_object().member("done", done).member("count", count).end_object();
}

void write_links(DocumentWriter& out, const Job& job) {
  const std::string self = link_to(job.id);
  out.begin_object()
      .member("self", self)
      .member("events", self + "/events")
      .member("result", self + "/result")
      .member("vtu", self + "/result.vtu")
      .member("picture", self + "/picture.svg")
      .member("contact_csv", self + "/contact.csv")
      .member("quantities_csv", self + "/quantities.csv")
      .member("history", self + "/history")
      .member("history_csv", self + "/history.csv")
      .end_object();
}

/// As far as it has come when this begins; many may read it, so that none has a copy of the whole.
void write_growing_history(DocumentWriter& out, const LiveSolve& live) {
  constexpr std::size_t most = 1024;
  std::vector<Iteration> block = live.history_after(0, most);
  std::size_t first = 0;
  api::write_history(out, live.iterations(), [&](std::size_t i) -> const Iteration& {
    if (i < first || i >= first + block.size()) block = live.history_after(first = i, most);
    return block[i - first];
  });
}

std::optional<std::string> link_to_next(const JobPage& page, const ListQuery& query) {
  if (!page.next) return std::nullopt;
  std::string link = "/v1/solves?limit=" + std::to_string(query.limit);
  if (query.status) link += "&status=" + std::string(name(*query.status));
  if (query.tag) link += "&tag=" + percent_encoded(*query.tag);
  if (query.title) link += "&title=" + percent_encoded(*query.title);
  return link + "&after=" + *page.next;
}

}  // namespace

std::string link_to(const std::string& id) {
  return "/v1/solves/" + id;
}

std::string link_to_batch(const std::string& id) {
  return "/v1/batches/" + id;
}

void write_progress_members(DocumentWriter& out, const Progress& progress) {
  member(out, "phase", progress.phase ? std::optional<std::string>(name(*progress.phase)) : std::nullopt);
  out.member("iteration", progress.iteration);
  member(out, "residual", progress.residual);
  if (progress.level)
    out.key("level")
        .begin_object()
        .member("number", progress.level->number)
        .member("triangles", progress.level->triangles)
        .member("bound", progress.level->bound)
        .member("relative", progress.level->relative)
        .end_object();
  if (progress.sweep > 0) write_done(out.key("sweep"), progress.swept, progress.sweep);
  if (progress.study > 0) write_done(out.key("study"), progress.studied, progress.study);
}

void write_status(DocumentWriter& out, const Job& job, const LiveSolve* live) {
  const Verdict& verdict = job.verdict;
  out.begin_object().member("id", job.id).member("status", name(job.status)).member("title", job.title);
  out.key("tags").texts(job.tags).member("created_at", iso8601(job.created));
  member(out, "started_at", text_of(job.started));
  member(out, "finished_at", text_of(job.finished));
  out.key("progress").begin_object();
  write_progress_members(out, progress_of(job, live));
  out.end_object();
  out.key("summary");
  if (verdict.summary) {
    api::write_summary(out, *verdict.summary);
  } else {
    out.null();
  }
  const std::string error = error_to_json(verdict.error);
  out.key("error").json(error.empty() ? "null" : error);
  write_links(out.key("links"), job);
  out.end_object();
}

void write_list(DocumentWriter& out, const JobPage& page, const ListQuery& query, const LiveSolves& lives) {
  out.begin_object().key("solves").begin_array();
  for (const Job& job : page.jobs) {
    const auto live = lives.find(job.id);
    write_status(out, job, live == lives.end() ? nullptr : live->second.get());
  }
  out.end_array().key("links").begin_object();
  member(out, "next", link_to_next(page, query));
  out.end_object().end_object();
}

void write_history_so_far(DocumentWriter& out, const JobWithResult& about, const LiveSolve* live) {
  out.begin_object().member("status", name(about.job.status)).key("history");
  if (about.result.history) {
    api::write_history(out, *about.result.history);
  } else if (live != nullptr) {
    write_growing_history(out, *live);
  } else {
    api::write_history(out, {});
  }
  out.end_object();
}

}  // namespace signorini::server
