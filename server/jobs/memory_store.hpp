#pragma once

#include <deque>
#include <map>
#include <mutex>

#include "server/jobs/retention_clock.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

/// Jobs in memory: `--data-dir :memory:`. What has ended is counted with the memory that it holds.
class MemoryStore : public JobStore {
 public:
  explicit MemoryStore(const StoreLimits& limits);

  std::string add(NewJob job) override;
  std::optional<std::string> earlier(const std::string& owner, const std::string& key,
                                     const std::string& problem) override;
  Batch add(NewBatch batch) override;
  std::optional<Batch> earlier_batch(const std::string& owner, const std::string& key,
                                     const std::string& digest) override;
  std::optional<Claim> claim() override;
  bool finish(const Claim& claim, const Ending& ending) override;
  bool give_back(const Claim& claim) override;
  Cancellation cancel(const std::string& id) override;
  bool remove_ended(const std::string& id) override;
  std::size_t remove_ended(std::span<const std::string> ids) override;
  void tidy() override;
  std::optional<Job> find(const std::string& id) const override;
  JobPage list(const ListQuery& query) const override;
  std::vector<std::string> ids(const ListQuery& query) const override;
  JobCounts count() const override;
  std::optional<Batch> find_batch(const std::string& id) const override;
  JobCounts count_of_batch(const std::string& id) const override;
  BatchEnds ends_of_batch(const std::string& id, std::int64_t since) const override;
  std::optional<JobResult> result(const std::string& id) override;
  std::size_t result_memory(const std::string&) const override { return 0; }
  std::size_t damaged() const override { return 0; }
  std::optional<std::string> trouble() override { return std::nullopt; }
  bool outlives_process() const override { return false; }

 private:
  struct Entry {
    Job job;
    JobResult result;
    std::optional<std::string> key;
    std::uint64_t attempt = 0;
    bool cancel_asked = false;
    std::size_t bytes = 0;   ///< counted when the job ended
    std::int64_t ended = 0;  ///< by the clock of retention
  };
  using Entries = std::map<std::string, Entry>;

  struct BatchEntry {
    Batch batch;
    std::optional<std::string> key;
    std::string digest;
    std::size_t jobs_left = 0;
  };

  /// Jobs that no longer stand in the map; their memory is freed after the lock is.
  using Removed = std::vector<Entries::node_type>;

  using Key = std::pair<std::string, std::string>;  ///< of an owner

  std::optional<std::string> job_with_key(const Key& key, const std::string& problem) const;
  std::optional<Batch> batch_with_key(const Key& key, const std::string& digest) const;
  void require_places(std::size_t jobs, const std::string& owner, const Share& share) const;
  void enqueue(NewJob job);
  std::size_t requests_in_queue() const;
  std::size_t queued(const std::string& owner) const;
  Entry* running(const Claim& claim);
  void end(Entry& entry, const Ending& ending, Removed& removed);
  void drop_beyond_limits(Removed& removed);
  void drop_oldest_ended(const char* flag, Removed& removed);
  void remove(const std::string& id, Removed& removed);
  bool remove_ended(const std::string& id, Removed& removed);

  const StoreLimits limits_;

  mutable std::mutex mutex_;
  Entries entries_;                  ///< by id, which is by age
  std::deque<std::string> queue_;    ///< ids, next first
  std::deque<std::string> ended_;    ///< ids in the order in which they ended
  std::map<Key, std::string> keys_;  ///< the id of the job or batch with this key
  std::map<std::string, BatchEntry> batches_;
  RetentionClock clock_;
  std::size_t ended_bytes_ = 0;
};

}  // namespace signorini::server
