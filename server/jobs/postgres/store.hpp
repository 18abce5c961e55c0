#pragma once

#include <atomic>
#include <chrono>
#include <string>

#include "server/jobs/fleet.hpp"
#include "server/jobs/postgres/database.hpp"
#include "server/jobs/postgres/leases.hpp"
#include "server/jobs/postgres/sweeper.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server::postgres {

/// Jobs in a PostgreSQL database, which several processes may share. A step that has returned is kept as
/// safely as the database keeps anything; where the connection breaks off as it is committed,
/// StoreUnavailable may be thrown for one that is done. What has ended is counted with the bytes that its
/// problem and result take, compressed.
class Store : public JobStore {
 public:
  /// `url` is postgresql://…; a claim is held for so long without being renewed. Throws CannotOpenStore.
  Store(const std::string& url, const StoreLimits& limits,
        std::chrono::milliseconds lease = std::chrono::seconds(10));

  std::string add(NewJob job) override;
  std::optional<std::string> earlier(const std::string& owner, const std::string& key,
                                     const std::string& problem) override;
  Batch add(NewBatch batch) override;
  std::optional<Batch> earlier_batch(const std::string& owner, const std::string& key,
                                     const std::string& digest) override;
  std::optional<Claim> claim() override { return leases_.claim({}); }
  bool finish(const Claim& claim, const Ending& ending) override;
  bool give_back(const Claim& claim) override { return leases_.give_back(claim); }
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
  std::optional<std::string> trouble() override { return database_.trouble(); }
  bool outlives_process() const override { return true; }
  Fleet* fleet() override { return &leases_; }

 private:
  template <class Known, class Add>
  auto add_unless(const Known& known, const Add& add) -> decltype(known());
  void require_places(Connection& connection, std::size_t jobs, const std::string& owner,
                      const Share& share) const;
  bool refuse(const Claim& claim, const std::string& verdict);
  static std::optional<JobResult> damaged_result(Connection& connection, const std::string& id,
                                                 const std::string& what);

  const StoreLimits limits_;
  const Database database_;
  Leases leases_;
  Sweeper sweeper_;
  mutable std::atomic<std::size_t> damaged_ = 0;  ///< as was counted last
};

}  // namespace signorini::server::postgres
