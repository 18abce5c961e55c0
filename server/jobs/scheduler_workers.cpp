// What its workers do.

#include "server/jobs/scheduler.hpp"

#include <algorithm>
#include <cmath>

#include <spdlog/spdlog.h>

#include "server/cores.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_time = 1s;   // a store that failed is asked again, and what expired is dropped
constexpr auto moment = 200ms;   // until others are looked at who solve the same sweep
constexpr auto retry_time = 1s;  // between two tries to keep an ending
constexpr auto patience_with_store = 60s;

constexpr std::size_t small_result = std::size_t{4} << 20;

bool is_small(const Ending& ending) {
  return memory_of({nullptr, ending.solution, ending.history}) <= small_result;
}

Ending result_not_kept() {
  Ending ending;
  ending.status = JobStatus::failed;
  ending.error = ProblemDetails{
      "result-not-kept", "The result could not be kept",
      "The problem was solved, but the data directory did not take the result; the log of the service says "
      "why. Send the problem again when there is room, or take a coarser mesh."};
  return ending;
}

double seconds_of(const Claim& claim) {
  using Seconds = std::chrono::duration<double>;
  return Seconds(std::chrono::system_clock::now() - *claim.job.started).count();
}

void log_end(const Claim& claim, const Ending& ending) {
  const LogField seconds("seconds", std::round(seconds_of(claim) * 1000) / 1000);
  if (!ending.solution) {
    spdlog::info("{} kind={}", name(ending.status), ending.error->kind);
    return;
  }
  const Summary& summary = ending.solution->summary;
  const LogField method("method", summary.method), iterations("iterations", std::int64_t{summary.iterations});
  const LogField triangles("triangles", summary.triangles);
  spdlog::info("{}", name(summary.outcome));
}

}  // namespace

void Scheduler::work() {
  give_way_to_answers();
  while (const std::optional<Running> running = next()) run_to_end(*running);
  {
    const std::lock_guard lock(mutex_);
    --working_;
  }
  ended_.notify_all();
}

void Scheduler::run_to_end(const Running& running) {
  const Claim& claim = running.claim;
  const LogField job("job", claim.job.id);
  std::optional<LogField> trace;
  if (!claim.job.trace.empty()) trace.emplace("trace", claim.job.trace);
  spdlog::info("started");
  count_memory(claim);
  std::optional<SharedSweep> shared;
  const bool is_whole = !claim.job.chunk;
  if (fleet_ != nullptr && is_whole) shared.emplace(*fleet_, store_, claim, *running.live, host());
  const Ending ending =
      run(claim, solve_, *running.live, memory_.left_for(claim.job.id), by_, shared ? &*shared : nullptr);
  log_end(claim, ending);
  if (is_whole) observer_(claim.job, ending);
  const bool small = is_small(ending);
  if (small) give_place();
  keep(running, ending);
  forget(running);
  // What is lost goes on elsewhere, and those who wait for it go on waiting.
  if (!running.live->is_lost() || !accepting()) announce_end(claim.job);
  if (!small) give_place();
}

void Scheduler::give_place() {
  {
    const std::lock_guard lock(mutex_);
    ++places_;
  }
  place_.notify_one();
}

/// Those that an earlier process accepted are counted from their start on.
void Scheduler::count_memory(const Claim& claim) {
  if (memory_.knows(claim.job.id) || !claim.problem) return;
  try {
    api::Request request = api::parse_request(*claim.problem);
    request.settings.factorization = by_;
    request.settings.threads = cores();
    const Estimates foreseen = estimate(request.problem, request.sweep, request.study, request.settings);
    memory_.add(claim.job.id, foreseen.memory_bytes(), claim.job.owner);
  } catch (const std::exception&) {
    // The run says what is wrong with the problem.
  }
}

std::optional<Scheduler::Running> Scheduler::next() {
  std::unique_lock lock(mutex_);
  for (;;) {
    place_.wait(lock, [&] { return draining_ || places_ > 0; });
    if (draining_) return std::nullopt;
    --places_;
    const std::uint64_t submissions = submissions_;
    lock.unlock();
    std::optional<Claim> claim = try_to_claim();
    lock.lock();
    if (claim) {
      const auto live = std::make_shared<LiveSolve>(*claim->job.started);
      if (stopping_) live->cancel();
      if (const auto watch = watch_of(claim->job.id)) watch->begin(live);
      const Running running{std::move(*claim), live};
      hold(running);
      return running;
    }
    queued_.wait_for(lock, idle_time, [&] { return draining_ || submissions_ != submissions; });
    ++places_;
  }
}

/// The mutex must be held.
void Scheduler::hold(const Running& running) {
  Running& place = running_[running.claim.job.id];
  // Another thread here has lost the job and may not know it yet.
  if (place.live) place.live->lose();
  place = running;
}

SweepHost Scheduler::host() {
  SweepHost host;
  host.hold = [this](const Claim& chunk) {
    const std::lock_guard lock(mutex_);
    hold({chunk, std::make_shared<LiveSolve>(*chunk.job.started)});
  };
  host.let_go = [this](const Claim& chunk) {
    const std::lock_guard lock(mutex_);
    const auto found = running_.find(chunk.job.id);
    if (found != running_.end() && found->second.claim.attempt == chunk.attempt) running_.erase(found);
  };
  host.tell = [this] { announce_submission(); };
  host.wait = [this] {
    std::unique_lock lock(mutex_);
    const std::uint64_t known = submissions_;
    queued_.wait_for(lock, moment, [&] { return stopping_ || submissions_ != known; });
  };
  return host;
}

std::optional<Claim> Scheduler::try_to_claim() {
  try {
    std::optional<Claim> claim = fleet_ != nullptr ? claim_what_fits() : store_.claim();
    if (!claim) store_.tidy();
    return claim;
  } catch (const StoreUnavailable&) {
    return std::nullopt;
  } catch (const std::exception& error) {
    spdlog::error("no solve could be taken from the queue: {}", error.what());
    return std::nullopt;
  }
}

/// A job for which there is memory here.
std::optional<Claim> Scheduler::claim_what_fits() {
  const std::lock_guard lock(claiming_);
  std::optional<Claim> claim = fleet_->claim({memory_.left(), memory_.most(), at_hand_()});
  if (claim) memory_.add(claim->job.id, claim->predicted_memory.value_or(0), claim->job.owner);
  return claim;
}

/// A store that fails may recover: what was solved is kept in memory meanwhile. If it does not, the job ends
/// without its result, for which there may be no room at all; and if the service is stopped first, the next
/// process solves it again. So does another one of the fleet if the claim is lost meanwhile.
void Scheduler::keep(const Running& running, const Ending& ending) {
  const auto until = std::chrono::steady_clock::now() + patience_with_store;
  while (std::chrono::steady_clock::now() < until) {
    if (try_to_keep(running, ending)) return;
    if (!pause()) return;
  }
  while (!running.live->is_lost() && !try_to_keep(running, result_not_kept())) {
    if (!pause()) return;
  }
}

/// False if it is worth another try.
bool Scheduler::try_to_keep(const Running& running, const Ending& ending) {
  const Claim& claim = running.claim;
  try {
    const bool interrupted = ending.status == JobStatus::cancelled && store_.outlives_process() &&
                             (!accepting() || running.live->is_lost());
    if (interrupted && store_.give_back(claim)) {
      spdlog::info(fleet_ != nullptr ? "queued again" : "queued again for the next start");
    } else if (!store_.finish(claim, ending)) {
      spdlog::error("it was not this worker's any more; its end is not kept");
      running.live->lose();
    }
    return true;
  } catch (const std::exception& error) {
    spdlog::error("its end could not be kept: {}", error.what());
    return false;
  }
}

/// Some time, or false as soon as the service stops.
bool Scheduler::pause() {
  std::unique_lock lock(mutex_);
  return !queued_.wait_for(lock, retry_time, [&] { return stopping_; });
}

}  // namespace signorini::server
