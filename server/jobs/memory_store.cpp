#include "server/jobs/memory_store.hpp"

#include <algorithm>
#include <unordered_set>

#include <spdlog/spdlog.h>

#include "server/log.hpp"

namespace signorini::server {
namespace {

bool is_asked_for(const Job& job, const ListQuery& query) {
  return (!query.status || job.status == *query.status) && (!query.owner || job.owner == *query.owner) &&
         (!query.tag || std::ranges::find(job.tags, *query.tag) != job.tags.end()) &&
         (!query.title || lower_case(job.title).find(lower_case(*query.title)) != std::string::npos);
}

}  // namespace

MemoryStore::MemoryStore(const StoreLimits& limits) : limits_(limits) {}

std::string MemoryStore::add(NewJob job) {
  const std::lock_guard lock(mutex_);
  if (job.key) {
    if (auto earlier = job_with_key({job.owner, *job.key}, *job.problem)) return *std::move(earlier);
  }
  require_places(1, job.owner, job.share);
  if (job.key) keys_[{job.owner, *job.key}] = job.id;
  const std::string id = job.id;
  enqueue(std::move(job));
  return id;
}

Batch MemoryStore::add(NewBatch batch) {
  const std::lock_guard lock(mutex_);
  const std::string& owner = batch.batch.owner;
  if (batch.key) {
    if (auto earlier = batch_with_key({owner, *batch.key}, batch.digest)) return *std::move(earlier);
  }
  require_places(batch.jobs.size(), owner, batch.jobs.front().share);
  if (batch.key) keys_[{owner, *batch.key}] = batch.batch.id;
  batches_[batch.batch.id] = {batch.batch, batch.key, batch.digest, batch.jobs.size()};
  for (NewJob& job : batch.jobs) enqueue(std::move(job));
  return batch.batch;
}

/// Throws QueueFull if no request more may wait, or not so many jobs of the owner.
void MemoryStore::require_places(std::size_t jobs, const std::string& owner, const Share& share) const {
  // There are no more requests than jobs, which are counted already.
  if (queue_.size() >= limits_.queue && requests_in_queue() >= limits_.queue) throw QueueFull(limits_.queue);
  if (share.queue && queued(owner) + jobs > *share.queue) throw QueueFull(*share.queue, true);
}

void MemoryStore::enqueue(NewJob job) {
  queue_.push_back(job.id);
  Entry& entry = entries_[job.id];
  entry.job.id = std::move(job.id);
  entry.job.title = std::move(job.title);
  entry.job.tags = std::move(job.tags);
  entry.job.trace = std::move(job.trace);
  entry.job.owner = std::move(job.owner);
  entry.job.batch = std::move(job.batch);
  entry.job.created = job.created;
  entry.result.problem = std::move(job.problem);
  entry.key = std::move(job.key);
}

std::optional<std::string> MemoryStore::earlier(const std::string& owner, const std::string& key,
                                                const std::string& problem) {
  const std::lock_guard lock(mutex_);
  return job_with_key({owner, key}, problem);
}

std::optional<std::string> MemoryStore::job_with_key(const Key& key, const std::string& problem) const {
  const auto found = keys_.find(key);
  if (found == keys_.end()) return std::nullopt;
  if (batches_.contains(found->second)) throw KeyReused(found->second, true);
  if (*entries_.at(found->second).result.problem != problem) throw KeyReused(found->second);
  return found->second;
}

std::optional<Batch> MemoryStore::earlier_batch(const std::string& owner, const std::string& key,
                                                const std::string& digest) {
  const std::lock_guard lock(mutex_);
  return batch_with_key({owner, key}, digest);
}

std::optional<Batch> MemoryStore::batch_with_key(const Key& key, const std::string& digest) const {
  const auto found = keys_.find(key);
  if (found == keys_.end()) return std::nullopt;
  const auto entry = batches_.find(found->second);
  if (entry == batches_.end()) throw KeyReused(found->second);
  if (entry->second.digest != digest) throw KeyReused(found->second, true);
  return entry->second.batch;
}

std::size_t MemoryStore::requests_in_queue() const {
  std::size_t alone = 0;
  std::unordered_set<std::string_view> batches;
  for (const std::string& id : queue_) {
    const std::string& batch = entries_.at(id).job.batch;
    if (batch.empty())
      ++alone;
    else
      batches.insert(batch);
  }
  return alone + batches.size();
}

std::size_t MemoryStore::queued(const std::string& owner) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      queue_, [&](const std::string& id) { return entries_.at(id).job.owner == owner; }));
}

std::optional<Claim> MemoryStore::claim() {
  const std::lock_guard lock(mutex_);
  if (queue_.empty()) return std::nullopt;
  Entry& entry = entries_.at(queue_.front());
  queue_.pop_front();
  entry.job.status = JobStatus::running;
  entry.job.started = std::chrono::system_clock::now();
  return Claim{entry.job, entry.result.problem, ++entry.attempt};
}

bool MemoryStore::finish(const Claim& claim, const Ending& ending) {
  Removed removed;
  const std::lock_guard lock(mutex_);
  Entry* const entry = running(claim);
  if (entry == nullptr) return false;
  end(*entry, ending, removed);
  return true;
}

bool MemoryStore::give_back(const Claim& claim) {
  const std::lock_guard lock(mutex_);
  Entry* const entry = running(claim);
  if (entry == nullptr || entry->cancel_asked) return false;
  entry->job.status = JobStatus::queued;
  entry->job.started.reset();
  queue_.insert(std::lower_bound(queue_.begin(), queue_.end(), claim.job.id), claim.job.id);
  return true;
}

Cancellation MemoryStore::cancel(const std::string& id) {
  Removed removed;
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end() || has_ended(found->second.job.status)) return Cancellation::none;
  Entry& entry = found->second;
  if (entry.job.status == JobStatus::running) {
    entry.cancel_asked = true;
    return Cancellation::asked;
  }
  queue_.erase(std::find(queue_.begin(), queue_.end(), id));
  end(entry, cancelled_ending("The solve was cancelled before it began."), removed);
  return Cancellation::ended;
}

bool MemoryStore::remove_ended(const std::string& id) {
  return remove_ended(std::span(&id, 1)) == 1;
}

std::size_t MemoryStore::remove_ended(std::span<const std::string> ids) {
  Removed removed;
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(ids, [&](const std::string& id) { return remove_ended(id, removed); }));
}

bool MemoryStore::remove_ended(const std::string& id, Removed& removed) {
  const auto place = std::find(ended_.begin(), ended_.end(), id);
  if (place == ended_.end()) return false;
  ended_.erase(place);
  remove(id, removed);
  return true;
}

void MemoryStore::tidy() {
  Removed removed;
  const std::lock_guard lock(mutex_);
  drop_beyond_limits(removed);
}

std::optional<Job> MemoryStore::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return std::nullopt;
  return found->second.job;
}

JobPage MemoryStore::list(const ListQuery& query) const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> jobs;
  std::optional<std::string> read_to;
  std::size_t titles = 0;
  auto next = std::make_reverse_iterator(query.after ? entries_.lower_bound(*query.after) : entries_.end());
  for (; next != entries_.rend() && jobs.size() <= query.limit && !read_to; ++next) {
    const Job& job = next->second.job;
    if (is_asked_for(job, query)) jobs.push_back(job);
    if (query.title && ++titles == titles_of_a_page) read_to = job.id;
  }
  return page_of(std::move(jobs), query.limit, std::move(read_to));
}

std::vector<std::string> MemoryStore::ids(const ListQuery& query) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> ids;
  for (auto job = entries_.rbegin(); job != entries_.rend(); ++job)
    if (is_asked_for(job->second.job, query)) ids.push_back(job->first);
  return ids;
}

JobCounts MemoryStore::count() const {
  const std::lock_guard lock(mutex_);
  JobCounts counts;
  for (const auto& [id, entry] : entries_) ++counts[entry.job.status];
  return counts;
}

std::optional<Batch> MemoryStore::find_batch(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const auto found = batches_.find(id);
  return found == batches_.end() ? std::nullopt : std::optional(found->second.batch);
}

JobCounts MemoryStore::count_of_batch(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  JobCounts counts;
  const auto found = batches_.find(id);
  if (found == batches_.end()) return counts;
  for (const std::string& job : found->second.batch.jobs) {
    const auto entry = entries_.find(job);
    if (entry != entries_.end()) ++counts[entry->second.job.status];
  }
  return counts;
}

BatchEnds MemoryStore::ends_of_batch(const std::string& id, std::int64_t since) const {
  const std::lock_guard lock(mutex_);
  BatchEnds ends;
  ends.latest = since;
  const auto found = batches_.find(id);
  if (found == batches_.end()) return ends;
  std::vector<std::pair<std::int64_t, std::string>> ended;
  for (const std::string& job : found->second.batch.jobs) {
    const auto entry = entries_.find(job);
    if (entry == entries_.end()) continue;
    if (!has_ended(entry->second.job.status))
      ends.all = false;
    else if (entry->second.ended >= since)
      ended.emplace_back(entry->second.ended, job);
  }
  std::ranges::stable_sort(ended, {}, &std::pair<std::int64_t, std::string>::first);
  for (auto& [time, job] : ended) ends.jobs.push_back(std::move(job));
  if (!ended.empty()) ends.latest = ended.back().first;
  return ends;
}

std::optional<JobResult> MemoryStore::result(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(id);
  if (found == entries_.end()) return std::nullopt;
  return found->second.result;
}

MemoryStore::Entry* MemoryStore::running(const Claim& claim) {
  const auto found = entries_.find(claim.job.id);
  if (found == entries_.end()) return nullptr;
  Entry& entry = found->second;
  return entry.attempt == claim.attempt && entry.job.status == JobStatus::running ? &entry : nullptr;
}

void MemoryStore::end(Entry& entry, const Ending& ending, Removed& removed) {
  entry.job.status = ending.status;
  entry.job.finished = std::chrono::system_clock::now();
  entry.ended = clock_.now();
  entry.job.verdict = verdict_of(ending);
  entry.result.solution = ending.solution;
  entry.result.history = ending.history;
  entry.bytes = sizeof(Entry) + memory_of(entry.result);
  ended_bytes_ += entry.bytes;
  ended_.push_back(entry.job.id);
  drop_beyond_limits(removed);
}

void MemoryStore::drop_beyond_limits(Removed& removed) {
  constexpr int most_at_once = 100;
  const std::int64_t oldest =
      clock_.now() - std::chrono::duration_cast<std::chrono::milliseconds>(limits_.keep).count();
  const bool by_age = !clock_.holds();
  for (int i = 0; by_age && i < most_at_once && !ended_.empty(); ++i) {
    if (entries_.at(ended_.front()).ended >= oldest) break;
    drop_oldest_ended("--keep-seconds", removed);
  }
  while (ended_bytes_ > limits_.keep_bytes && ended_.size() > 1) drop_oldest_ended("--keep-bytes", removed);
}

void MemoryStore::drop_oldest_ended(const char* flag, Removed& removed) {
  remove(ended_.front(), removed);
  const LogField job("job", ended_.front());
  spdlog::info("dropped bytes={} kept_bytes={} ({})", removed.back().mapped().bytes, ended_bytes_, flag);
  ended_.pop_front();
}

void MemoryStore::remove(const std::string& id, Removed& removed) {
  removed.push_back(entries_.extract(id));
  const Entry& entry = removed.back().mapped();
  ended_bytes_ -= entry.bytes;
  if (entry.key) keys_.erase({entry.job.owner, *entry.key});
  const auto batch = batches_.find(entry.job.batch);
  if (batch == batches_.end() || --batch->second.jobs_left > 0) return;
  if (batch->second.key) keys_.erase({entry.job.owner, *batch->second.key});
  batches_.erase(batch);
}

}  // namespace signorini::server
