#pragma once

#include <filesystem>
#include <mutex>
#include <string>

#include "server/jobs/retention_clock.hpp"
#include "server/jobs/sqlite/commit_queue.hpp"
#include "server/jobs/sqlite/data_dir.hpp"
#include "server/jobs/sqlite/database.hpp"
#include "server/jobs/sqlite/disk_reserve.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

/// Jobs in an SQLite database. A step that has returned is on the disk. What has ended is counted with the
/// bytes that its problem and result take there, compressed.
///
/// There is one connection that writes, by a CommitQueue. Status calls read by another one, and each result
/// by one of its own, so that neither waits for a large result to be written or read.
class SqliteStore : public JobStore {
 public:
  /// Opens the jobs of a directory, repaired if they are damaged; those that a process that died left as
  /// running are queued again, or end as failed after their third attempt. `vfs` is the name of the SQLite
  /// file layer, empty for the usual one. Throws CannotOpenStore.
  SqliteStore(const std::filesystem::path& directory, const StoreLimits& limits, const std::string& vfs = {});

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
  std::size_t result_memory(const std::string& id) const override;
  std::size_t damaged() const override;
  std::optional<std::string> trouble() override;
  bool outlives_process() const override { return true; }

 private:
  template <class Step>
  auto write(const Step& step, Survives survives = Survives::machine);
  template <class Step>
  auto write_what_frees(const Step& step);
  template <class Step>
  auto read(const Step& step) const;

  void recover();
  std::optional<std::string> hindrance();
  bool has_room();
  void require_room();
  void require_growth(std::size_t bytes) const;
  std::optional<std::string> job_with_key(const Database& database, const std::string& owner,
                                          const std::string& key, const std::string& problem) const;
  std::optional<Batch> batch_with_key(const Database& database, const std::string& owner,
                                      const std::string& key, const std::string& digest) const;
  void require_places(std::size_t jobs, const std::string& owner, const Share& share);
  void insert(const NewJob& job, const std::string& packed_problem);
  bool end(const std::string& id, JobStatus status, std::optional<std::uint64_t> attempt,
           const Ending& ending, const std::string& findings);
  void drop_beyond_limits();
  bool drop_oldest_beyond_limits(bool by_age);
  void shrink();
  std::optional<JobResult> damaged_result(const std::string& id, const std::string& what);
  void note_trouble(const SQLite::Exception& error) const;

  const StoreLimits limits_;
  const DataDir directory_;
  const std::string vfs_;

  mutable std::mutex trouble_mutex_;
  mutable std::optional<std::string> trouble_;  ///< of the last write, which may pass
  mutable std::optional<std::string> damage_;   ///< of the database, which stays
  DiskReserve reserve_;

  Database writer_;
  CommitQueue commits_{writer_};
  RetentionClock clock_;  ///< used within steps only

  mutable std::mutex reading_;
  mutable Database reader_;
};

}  // namespace signorini::server
