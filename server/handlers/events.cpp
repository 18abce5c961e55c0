#include "server/handlers/events.hpp"

#include <charconv>
#include <string_view>

#include "api/result/result_members.hpp"
#include "server/handlers/documents.hpp"
#include "server/handlers/find_job.hpp"
#include "server/http/error.hpp"
#include "server/http/query.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {
namespace {

/// How many iterations are told in one go: some kilobytes, which a client who does not take them keeps.
constexpr std::size_t most_rows = 16;

/// The place in a stream after an event. Iterations count from the start of the solve that did them: a solve
/// that is begun anew tells all of them again.
struct Place {
  std::int64_t run = 0;  ///< when the solve started, in milliseconds; 0 before
  std::size_t rows = 0;  ///< iterations that were told
  bool end = false;
};

std::int64_t run_of(Time started) {
  return std::chrono::floor<std::chrono::milliseconds>(started.time_since_epoch()).count();
}

/// `RUN-ROWS`, and `RUN-end` of the last event.
std::string event_id(const Place& place) {
  return std::to_string(place.run) + '-' + (place.end ? "end" : std::to_string(place.rows));
}

HttpError bad_event_id() {
  return {400,
          {"bad-event-id", "Bad Last-Event-ID", "A Last-Event-ID is the `id` of an event of this stream."}};
}

/// Where the client wants to go on.
Place place_of(const Request& request) {
  const std::optional<std::string> id = request.header("Last-Event-ID");
  Place place;
  if (!id || id->empty()) return place;
  const char* const last = id->data() + id->size();
  const auto run = std::from_chars(id->data(), last, place.run);
  if (run.ec != std::errc() || run.ptr == last || *run.ptr != '-') throw bad_event_id();
  place.end = std::string_view(run.ptr + 1, last) == "end";
  if (place.end) return place;
  const auto rows = std::from_chars(run.ptr + 1, last, place.rows);
  if (rows.ec != std::errc() || rows.ptr != last) throw bad_event_id();
  return place;
}

/// One event with a document as its data, which holds no line break.
void append_event(std::string& text, std::string_view name, const std::optional<std::string>& id,
                  const api::WriteDocument& write) {
  text.append("event: ").append(name).append("\n");
  if (id) text.append("id: ").append(*id).append("\n");
  text.append("data: ");
  api::write_document(
      api::Format::json,
      [&](std::string_view piece) {
        text += piece;
        return true;
      },
      write);
  text.append("\n\n");
}

/// How far the solve is.
void append_state(std::string& text, const Progress& progress) {
  append_event(text, "progress", std::nullopt, [&](api::DocumentWriter& out) {
    out.begin_object();
    write_progress_members(out, progress);
    out.end_object();
  });
}

/// One iteration, as the history will have it. `progress` is that of the solve around it.
void append_iteration(std::string& text, const Place& place, Progress progress, const Iteration& iteration) {
  progress.iteration = iteration.number;
  progress.residual = residual(iteration);
  append_event(text, "progress", event_id(place), [&](api::DocumentWriter& out) {
    out.begin_object();
    write_progress_members(out, progress);
    api::write_iteration(out.key("history"), iteration);
    out.end_object();
  });
}

void append_end(std::string& text, const Job& job) {
  const std::int64_t run = job.started ? run_of(*job.started) : 0;
  append_event(text, name(job.status), event_id({run, 0, true}),
               [&](api::DocumentWriter& out) { write_status(out, job, nullptr); });
}

bool differ(const Progress& a, const Progress& b) {
  const auto level = [](const Progress& progress) { return progress.level ? progress.level->number : 0; };
  return a.phase != b.phase || level(a) != level(b) || a.swept != b.swept || a.studied != b.studied;
}

/// The events of a job that had not ended when somebody began to watch it.
class SolveEvents : public EventSource {
 public:
  SolveEvents(const JobStore& store, std::string id, std::shared_ptr<const Watch> watch, const Place& place)
      : store_(store), id_(std::move(id)), watch_(std::move(watch)), place_(place) {}

  bool next(std::string& text) override {
    // Asked first: what is told then is all there is.
    const bool over = watch_->over();
    const auto live = watch_->live();
    if (live && !tell_solve(text, *live)) return true;
    if (!live && !told_) append_state(text, Progress());
    if (!live && !told_) told_ = Progress();
    return !over || !tell_end(text);
  }

 private:
  /// False if there is more.
  bool tell_solve(std::string& text, const LiveSolve& live) {
    const std::int64_t run = run_of(live.started());
    if (place_.run != run) place_ = {run};
    const auto [progress, rows] = live.advance_after(place_.rows, most_rows);
    if (!told_ || differ(*told_, progress)) append_state(text, progress);
    told_ = progress;
    for (const Iteration& row : rows) {
      ++place_.rows;
      append_iteration(text, place_, progress, row);
    }
    return rows.size() < most_rows;
  }

  /// False if the store does not answer for now.
  bool tell_end(std::string& text) {
    try {
      const std::optional<Job> job = store_.find(id_);
      // One that waits for the next process goes on there, and so may its client.
      if (job && has_ended(job->status)) append_end(text, *job);
      return true;
    } catch (const StoreUnavailable&) {
      return false;
    }
  }

  const JobStore& store_;
  const std::string id_;
  const std::shared_ptr<const Watch> watch_;
  Place place_;
  std::optional<Progress> told_;
};

Response event_response(const Job& job) {
  Response response = Response::empty(200);
  response.job = job.id;
  response.content_type = event_stream_media_type;
  // A proxy must not collect events.
  response.headers.emplace_back("X-Accel-Buffering", "no");
  return response;
}

/// What the client has missed of a solve that has ended.
Response ended_response(Service& service, Job job, const Place& place) {
  if (place.end && (!job.started || place.run == run_of(*job.started))) return Response::empty(204);
  Response response = event_response(job);
  JobResult result;
  if (job.verdict.last_iteration) result = with_result(service, job).result;
  response.write_body = [job = std::move(job), result = std::move(result), place](const PieceSink& sink) {
    Place now{job.started ? run_of(*job.started) : 0};
    if (now.run == place.run) now.rows = place.rows;
    std::string text;
    while (result.history && now.rows < result.history->size()) {
      const Iteration& row = (*result.history)[now.rows++];
      append_iteration(text, now, Progress(), row);
      if (text.size() > api::PieceWriter::piece_size && !sink(std::exchange(text, {}))) return false;
    }
    append_end(text, job);
    return sink(text);
  };
  return response;
}

}  // namespace

HttpError too_many_subscribers(std::size_t limit) {
  return {503,
          {"too-many-subscribers", "Too many subscribers",
           std::to_string(limit) +
               " streams of events and of results are open, which is the limit (--max-subscribers). "
               "GET the status document now and then instead."},
          {{"Retry-After", "10"}}};
}

Response get_events(Service& service, const Request& request) {
  allow_only(request.query, {});
  const Place place = place_of(request);
  Job job = find_job(service, request);
  const auto watch = service.scheduler.watch(job.id);
  // Asked again: if it had ended before it was watched, nobody would tell.
  job = find_job(service, request);
  if (has_ended(job.status)) return ended_response(service, std::move(job), place);
  Response response = event_response(job);
  if (request.method == "HEAD") return response;
  const std::shared_ptr<void> seat = service.events.open_streams().try_acquire();
  if (!seat) throw too_many_subscribers(service.events.open_streams().count());
  const auto source = std::make_shared<SolveEvents>(service.store, job.id, watch, place);
  response.take_connection = [&events = service.events, source, seat](int socket, std::string head) {
    events.add(socket, std::move(head), source, seat);
  };
  return response;
}

}  // namespace signorini::server
