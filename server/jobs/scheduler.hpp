#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <span>
#include <stdexcept>
#include <thread>
#include <vector>

#include "server/jobs/heart.hpp"
#include "server/jobs/lookout.hpp"
#include "server/jobs/memory_budget.hpp"
#include "server/jobs/run.hpp"
#include "server/jobs/shared_sweep.hpp"
#include "server/jobs/store.hpp"
#include "server/jobs/watch.hpp"

namespace signorini::server {

/// The service takes no more jobs because it is about to end.
class Stopping : public std::runtime_error {
 public:
  Stopping() : std::runtime_error("the service is stopping") {}
};

/// What became of a job that a client does not want any more.
enum class Dismissal { unknown, cancelled, cancelling, removed };

using LiveSolves = std::map<std::string, std::shared_ptr<const LiveSolve>>;

/// The marks of the operators that are at hand.
using OperatorsAtHand = std::function<std::vector<std::int64_t>()>;

/// Told how each run of a job ended, before its end is kept.
using EndObserver = std::function<void(const Job& job, const Ending& ending)>;

/// Runs the jobs of a store, as many at a time as there are workers. One whose result is small gives its
/// place to the next one before its end is on the disk. Where several processes share the store, each has its
/// workers, and clients of each see what all of them do.
class Scheduler {
 public:
  /// The solves that run at the same time are to take no more than `max_memory` bytes together, as predicted
  /// for the factorisation.
  Scheduler(
      JobStore& store, SolveFunction solve, int workers,
      double max_memory = std::numeric_limits<double>::infinity(), EndObserver observer = [](auto&&...) {},
      Factorization by = Factorization::multifrontal,
      OperatorsAtHand at_hand = [] { return std::vector<std::int64_t>(); });
  ~Scheduler();

  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

  /// The id that JobStore::add() returns. Throws what that throws, and for a new job MemoryFull, and Stopping
  /// once drain() was called.
  std::string submit(NewJob job);

  /// The same of a batch, as a whole.
  Batch submit(NewBatch batch);

  /// What happens to a job from now on. One that has ended is never `over`: ask the store after this call. Of
  /// a batch: it is `over` as soon as one of its jobs has ended.
  std::shared_ptr<const Watch> watch(const std::string& id);

  /// Cancels a job that has not ended: a running one ends at its next check.
  void cancel(const std::string& id);

  /// Cancels a job that has not ended, else removes it.
  Dismissal dismiss(const std::string& id);

  /// The solve of a job while it runs, else null. Of one that another process runs: how far it was a moment
  /// ago.
  std::shared_ptr<const LiveSolve> live(const std::string& id) const;

  /// The same of those of the jobs that run, by their ids; what others have iterated is not in it.
  LiveSolves live(std::span<const Job> jobs) const;

  bool accepting() const;

  /// Takes no more jobs and begins none; the running ones go on.
  void drain();

  /// Whether no job runs any more after drain(), waiting so long for it.
  bool wait_until_idle(std::chrono::milliseconds time);

  /// Drains, and ends the running jobs at their next check.
  void cancel_running();

  /// Queues again what still runs, for the next process. Nothing may follow but the end of this one.
  void leave_running();

  /// cancel_running(), and returns when every thread has ended.
  /// What has not ended then waits in the store for the next process, or is cancelled if the store ends with
  /// this one. May be called again.
  void stop();

 private:
  struct Running {
    Claim claim;
    std::shared_ptr<LiveSolve> live;
  };

  void work();
  void run_to_end(const Running& running);
  SweepHost host();
  void hold(const Running& running);
  void count_memory(const Claim& claim);
  std::optional<Running> next();
  void give_place();
  void admit(const NewJob& job);
  std::optional<Claim> try_to_claim();
  std::optional<Claim> claim_what_fits();
  bool try_to_keep(const Running& running, const Ending& ending);
  void keep(const Running& running, const Ending& ending);
  bool pause();
  std::vector<Held> held() const;
  LookoutEars ears();
  LiveSolves look_elsewhere(const std::vector<std::string>& ids, bool iterations) const;
  void announce_end(const Job& job);
  void forget(const Running& running);
  void end_watch(const std::string& id);
  void announce_submission();
  std::shared_ptr<Watch> watch_of(const std::string& id) const;
  std::optional<Dismissal> try_to_cancel(const std::string& id);
  bool cancel_live(const std::string& id);
  void cancel_all_queued();

  JobStore& store_;
  Fleet* const fleet_;  ///< null if nobody else uses the store
  const SolveFunction solve_;
  const EndObserver observer_;
  const Factorization by_;
  const OperatorsAtHand at_hand_;
  MemoryBudget memory_;

  std::shared_mutex admission_;  ///< held by those who queue a job, and by drain() alone

  // Never held while the store is asked, which may take as long as a disk does.
  mutable std::mutex mutex_;
  std::condition_variable queued_;  ///< a job was queued, or drain, or stop
  std::condition_variable place_;   ///< there is one, or drain
  std::condition_variable ended_;   ///< a thread has ended
  bool draining_ = false;
  bool stopping_ = false;
  int working_;  ///< threads that have a job or would take one
  int places_;   ///< solves that may begin
  std::uint64_t submissions_ = 0;
  std::map<std::string, Running> running_;               ///< by the id of the job
  std::map<std::string, std::weak_ptr<Watch>> watches_;  ///< by the id of the job or batch; shared by all

  std::mutex claiming_;  ///< what one takes of the memory is counted before another asks what is left

  std::optional<Heart> heart_;
  std::optional<Lookout> lookout_;

  std::mutex joining_;
  std::vector<std::thread> threads_;
};

}  // namespace signorini::server
