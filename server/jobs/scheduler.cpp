#include "server/jobs/scheduler.hpp"

#include <algorithm>
#include <cmath>

#include <sys/resource.h>

#include <spdlog/spdlog.h>

#include "server/log.hpp"

namespace signorini::server {
namespace {

using namespace std::chrono_literals;

constexpr auto idle_time = 1s;   // a store that failed is asked again, and what expired is dropped
constexpr auto retry_time = 1s;  // between two tries to keep an ending
constexpr auto patience_with_store = 60s;

/// While some wait for the disk with small results, others solve.
int threads_for(int workers) {
  return workers + std::min(3 * workers, 12);
}

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

Scheduler::Scheduler(JobStore& store, SolveFunction solve, int workers, double max_memory,
                     EndObserver observer, Factorization by, OperatorsAtHand at_hand)
    : store_(store),
      fleet_(store.fleet()),
      solve_(std::move(solve)),
      observer_(std::move(observer)),
      by_(by),
      at_hand_(std::move(at_hand)),
      memory_(max_memory, static_cast<std::size_t>(workers)),
      working_(threads_for(workers)),
      places_(workers) {
  if (fleet_ != nullptr) {
    heart_.emplace(*fleet_, [this] { return held(); });
    lookout_.emplace(*fleet_, ears());
  }
  for (int i = 0; i < threads_for(workers); ++i) threads_.emplace_back(&Scheduler::work, this);
}

Scheduler::~Scheduler() {
  stop();
}

std::string Scheduler::submit(NewJob job) {
  // One that is there already takes nothing more.
  if (job.key) {
    if (auto earlier = store_.earlier(job.owner, *job.key, *job.problem)) return *std::move(earlier);
  }
  // So that no job is queued after stop() has emptied the queue.
  const std::shared_lock admitted(admission_);
  if (!accepting()) throw Stopping();
  const std::string new_id = job.id;
  admit(job);
  std::string id;
  try {
    id = store_.add(std::move(job));
  } catch (...) {
    memory_.release(new_id);
    throw;
  }
  if (id != new_id) memory_.release(new_id);
  announce_submission();
  return id;
}

/// Throws MemoryFull. In a fleet it is not known which of its processes will run the job, and when: it waits
/// until one has room for it.
void Scheduler::admit(const NewJob& job) {
  if (fleet_ != nullptr)
    memory_.require_alone(job.predicted_memory, job.owner, job.share.memory);
  else
    memory_.admit(job.id, job.predicted_memory, job.owner, job.share.memory);
}

Batch Scheduler::submit(NewBatch batch) {
  const std::string& owner = batch.batch.owner;
  if (batch.key) {
    if (auto earlier = store_.earlier_batch(owner, *batch.key, batch.digest)) return *std::move(earlier);
  }
  const std::shared_lock admitted(admission_);
  if (!accepting()) throw Stopping();
  const std::vector<std::string> jobs = batch.batch.jobs;
  const auto release = [&] {
    for (const std::string& id : jobs) memory_.release(id);
  };
  try {
    for (const NewJob& job : batch.jobs) admit(job);
    const std::string new_id = batch.batch.id;
    Batch accepted = store_.add(std::move(batch));
    if (accepted.id != new_id) release();
    announce_submission();
    return accepted;
  } catch (...) {
    release();
    throw;
  }
}

void Scheduler::announce_submission() {
  {
    const std::lock_guard lock(mutex_);
    ++submissions_;
  }
  queued_.notify_all();
  if (lookout_) lookout_->hint();
}

std::shared_ptr<const Watch> Scheduler::watch(const std::string& id) {
  const std::lock_guard lock(mutex_);
  std::erase_if(watches_, [](const auto& each) { return each.second.expired(); });
  std::weak_ptr<Watch>& place = watches_[id];
  if (std::shared_ptr<Watch> watch = place.lock()) return watch;
  const auto watch = std::make_shared<Watch>();
  const auto running = running_.find(id);
  if (running != running_.end()) watch->begin(running->second.live);
  place = watch;
  return watch;
}

void Scheduler::cancel(const std::string& id) {
  for (;;) {
    const std::optional<Job> job = store_.find(id);
    if (!job || has_ended(job->status) || try_to_cancel(id)) return;
    std::this_thread::yield();
  }
}

Dismissal Scheduler::dismiss(const std::string& id) {
  // A job may step on between two of these; then the next round finds it where it went.
  while (store_.find(id)) {
    if (store_.remove_ended(id)) return Dismissal::removed;
    if (const std::optional<Dismissal> dismissal = try_to_cancel(id)) return *dismissal;
    std::this_thread::yield();
  }
  return Dismissal::unknown;
}

/// Nothing if the job has ended, or is between two steps.
std::optional<Dismissal> Scheduler::try_to_cancel(const std::string& id) {
  const Cancellation cancellation = store_.cancel(id);
  if (cancellation == Cancellation::ended) {
    // It may be removed already; then nobody waits for it but those who look by themselves.
    Job ended = store_.find(id).value_or(Job());
    ended.id = id;
    announce_end(ended);
    const LogField job("job", id);
    spdlog::info("cancelled while queued");
    return Dismissal::cancelled;
  }
  // Who runs it elsewhere sees it when he renews his claim.
  const bool hears = cancellation == Cancellation::asked && (cancel_live(id) || fleet_ != nullptr);
  return hears ? std::optional(Dismissal::cancelling) : std::nullopt;
}

std::shared_ptr<const LiveSolve> Scheduler::live(const std::string& id) const {
  {
    const std::lock_guard lock(mutex_);
    const auto found = running_.find(id);
    if (found != running_.end()) return found->second.live;
  }
  if (fleet_ == nullptr) return nullptr;
  const LiveSolves elsewhere = look_elsewhere({id});
  return elsewhere.empty() ? nullptr : elsewhere.begin()->second;
}

LiveSolves Scheduler::live(std::span<const Job> jobs) const {
  LiveSolves lives;
  std::vector<std::string> elsewhere;
  {
    const std::lock_guard lock(mutex_);
    for (const Job& job : jobs) {
      const auto found = running_.find(job.id);
      if (found != running_.end())
        lives[job.id] = found->second.live;
      else if (job.status == JobStatus::running)
        elsewhere.push_back(job.id);
    }
  }
  if (fleet_ != nullptr) lives.merge(look_elsewhere(elsewhere));
  return lives;
}

/// Of those that run in other processes of the fleet.
LiveSolves Scheduler::look_elsewhere(const std::vector<std::string>& ids) const {
  LiveSolves lives;
  if (ids.empty()) return lives;
  std::vector<Sought> sought;
  for (const std::string& id : ids) sought.push_back({id});
  for (const Found& found : fleet_->look(sought)) {
    if (found.status != JobStatus::running || !found.started) continue;
    const auto live = std::make_shared<LiveSolve>(*found.started);
    live->follow(found.progress, found.iterations);
    lives[found.job] = live;
  }
  return lives;
}

std::vector<Held> Scheduler::held() const {
  const std::lock_guard lock(mutex_);
  std::vector<Held> all;
  for (const auto& [id, running] : running_) all.push_back({id, running.claim.attempt, running.live});
  return all;
}

LookoutEars Scheduler::ears() {
  LookoutEars ears;
  ears.sought = [this] {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> ids;
    for (const auto& [id, watch] : watches_)
      if (!watch.expired() && !running_.contains(id)) ids.push_back(id);
    return ids;
  };
  ears.begun = [this](const std::string& id, const std::shared_ptr<const LiveSolve>& live) {
    const std::lock_guard lock(mutex_);
    const auto watch = watch_of(id);
    if (watch && !running_.contains(id)) watch->begin(live);
  };
  ears.ended = [this](const std::string& id) { end_watch(id); };
  ears.queued = [this] {
    {
      const std::lock_guard lock(mutex_);
      ++submissions_;
    }
    queued_.notify_all();
  };
  return ears;
}

bool Scheduler::accepting() const {
  const std::lock_guard lock(mutex_);
  return !draining_;
}

void Scheduler::drain() {
  {
    const std::lock_guard alone(admission_);
    const std::lock_guard lock(mutex_);
    draining_ = true;
  }
  if (!store_.outlives_process()) cancel_all_queued();
  queued_.notify_all();
  place_.notify_all();
}

bool Scheduler::wait_until_idle(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return ended_.wait_for(lock, time, [&] { return working_ == 0; });
}

void Scheduler::cancel_running() {
  drain();
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    for (const auto& [id, running] : running_) running.live->cancel();
  }
  queued_.notify_all();
}

void Scheduler::leave_running() {
  std::map<std::string, Running> running;
  {
    const std::lock_guard lock(mutex_);
    running = running_;
  }
  for (const auto& [id, each] : running) {
    const LogField job("job", id);
    try {
      if (store_.give_back(each.claim)) spdlog::warn("queued again for the next start, for it does not end");
    } catch (const std::exception& error) {
      spdlog::error("could not be queued again: {}", error.what());
    }
  }
}

void Scheduler::stop() {
  cancel_running();
  const std::lock_guard joining(joining_);
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

void Scheduler::work() {
  // On Linux, of this thread alone: a solve takes the time that answers leave.
  setpriority(PRIO_PROCESS, 0, 10);
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
  const Ending ending = run(claim, solve_, *running.live, memory_.left_for(claim.job.id), by_);
  log_end(claim, ending);
  observer_(claim.job, ending);
  const bool small = is_small(ending);
  if (small) give_place();
  keep(running, ending);
  // What is lost goes on elsewhere, and those who wait for it go on waiting.
  if (running.live->is_lost() && accepting())
    forget(claim.job);
  else
    announce_end(claim.job);
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
    auto runs = request.study ? estimate(request.problem, *request.study, by_) : std::vector<Estimate>();
    for (Estimate& each : runs) each = for_solve(each, request.settings);
    const Estimate problem = estimate(request.problem, request.sweep, request.settings);
    memory_.add(claim.job.id, memory_with_study(problem, runs), claim.job.owner);
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
      running_[running.claim.job.id] = running;
      return running;
    }
    queued_.wait_for(lock, idle_time, [&] { return draining_ || submissions_ != submissions; });
    ++places_;
  }
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
  std::optional<Claim> claim = fleet_->claim({memory_.left(), at_hand_()});
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

void Scheduler::announce_end(const Job& job) {
  forget(job);
  for (const std::string& watched : {job.id, job.batch}) end_watch(watched);
  if (lookout_) lookout_->hint();
}

void Scheduler::forget(const Job& job) {
  memory_.release(job.id);
  const std::lock_guard lock(mutex_);
  running_.erase(job.id);
}

void Scheduler::end_watch(const std::string& id) {
  const std::lock_guard lock(mutex_);
  if (const auto watch = watch_of(id)) watch->end();
  watches_.erase(id);
}

/// Null if nobody watches the job. The mutex must be held.
std::shared_ptr<Watch> Scheduler::watch_of(const std::string& id) const {
  const auto found = watches_.find(id);
  return found == watches_.end() ? nullptr : found->second.lock();
}

bool Scheduler::cancel_live(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(id);
  if (found == running_.end()) return false;
  found->second.live->cancel();
  const LogField job("job", id);
  spdlog::info("cancelling");
  return true;
}

void Scheduler::cancel_all_queued() {
  ListQuery queued;
  queued.status = JobStatus::queued;
  JobPage page;
  do {
    page = store_.list(queued);
    for (const Job& job : page.jobs) {
      if (store_.cancel(job.id) != Cancellation::ended) continue;
      announce_end(job);
      const LogField field("job", job.id);
      spdlog::info("cancelled while queued");
    }
  } while (page.more);
}

}  // namespace signorini::server
