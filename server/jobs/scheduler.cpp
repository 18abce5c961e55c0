#include "server/jobs/scheduler.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/log.hpp"

namespace signorini::server {
namespace {

/// While some wait for the disk with small results, others solve.
int threads_for(int workers) {
  return workers + std::min(3 * workers, 12);
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
    memory_.release(id);
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
  const LiveSolves elsewhere = look_elsewhere({id}, true);
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
  if (fleet_ != nullptr) lives.merge(look_elsewhere(elsewhere, false));
  return lives;
}

/// Of those that run in other processes of the fleet.
LiveSolves Scheduler::look_elsewhere(const std::vector<std::string>& ids, bool iterations) const {
  LiveSolves lives;
  if (ids.empty()) return lives;
  std::vector<Sought> sought;
  for (const std::string& id : ids) sought.push_back({.job = id, .iterations = iterations});
  for (const Found& found : fleet_->look(sought)) {
    if (found.status != JobStatus::running || !found.started) continue;
    const auto live = std::make_shared<LiveSolve>(*found.started);
    live->follow(found.advance);
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
    if (watch && !running_.contains(id)) watch->begin_elsewhere(live);
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

void Scheduler::announce_end(const Job& job) {
  for (const std::string& watched : {job.id, job.batch}) end_watch(watched);
  if (lookout_) lookout_->hint();
}

/// If the job was lost, another thread here may have it by now.
void Scheduler::forget(const Running& running) {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(running.claim.job.id);
  if (found == running_.end() || found->second.live != running.live) return;
  memory_.release(found->first);
  running_.erase(found);
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
      memory_.release(job.id);
      announce_end(job);
      const LogField field("job", job.id);
      spdlog::info("cancelled while queued");
    }
  } while (page.next);
}

}  // namespace signorini::server
