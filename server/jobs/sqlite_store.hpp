#pragma once

#include <filesystem>
#include <mutex>
#include <string>

#include <SQLiteCpp/SQLiteCpp.h>

#include "server/jobs/data_dir.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

/// Jobs in an SQLite database. A step that has returned is on the disk. What has ended is counted with the
/// bytes that its problem and result take there, compressed.
///
/// There is one connection that writes, one step at a time. Status calls read by another one, and each
/// result by one of its own, so that neither waits for a large result to be written or read.
class SqliteStore : public JobStore {
 public:
  /// Opens the jobs of a directory; those that a process that died left as running are queued again, or end
  /// as failed after their third attempt. `vfs` is the name of the SQLite file layer, empty for the usual
  /// one. Throws CannotOpenStore.
  SqliteStore(const std::filesystem::path& directory, const StoreLimits& limits, const std::string& vfs = {});

  std::string add(NewJob job) override;
  std::optional<Claim> claim() override;
  bool finish(const Claim& claim, const Ending& ending) override;
  bool give_back(const Claim& claim) override;
  Cancellation cancel(const std::string& id) override;
  bool remove_ended(const std::string& id) override;
  void drop_expired() override;
  std::optional<Job> find(const std::string& id) const override;
  JobPage list(const ListQuery& query) const override;
  JobCounts count() const override;
  std::optional<JobResult> result(const std::string& id) const override;
  std::optional<std::string> trouble() override;
  bool outlives_process() const override { return true; }

 private:
  template <class Step>
  auto write(const Step& step);
  template <class Step>
  auto read(const Step& step) const;

  void recover();
  std::optional<std::string> job_with_key(const std::string& key, const std::string& problem);
  bool end(const std::string& id, const std::string& condition, const Ending& ending,
           const std::string& findings);
  void drop_beyond_limits();

  const StoreLimits limits_;
  const DataDir directory_;
  const std::string vfs_;

  std::mutex writing_;
  SQLite::Database writer_;
  std::int64_t ended_bytes_ = 0;

  mutable std::mutex reading_;
  mutable SQLite::Database reader_;

  std::mutex trouble_mutex_;
  std::optional<std::string> trouble_;
};

}  // namespace signorini::server
