#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/jobs/batch.hpp"
#include "server/jobs/job.hpp"

namespace signorini::server {

/// As many requests wait as may wait, a batch being one, or as many jobs of one owner.
class QueueFull : public std::runtime_error {
 public:
  explicit QueueFull(std::size_t queue_limit, bool only_share = false)
      : std::runtime_error("the queue is full"), limit(queue_limit), share(only_share) {}

  std::size_t limit;
  bool share;  ///< it is the share of one owner that is used up
};

/// The idempotency key came with something else before.
class KeyReused : public std::runtime_error {
 public:
  explicit KeyReused(std::string earlier, bool is_batch = false)
      : std::runtime_error("the idempotency key belongs to another problem"),
        id(std::move(earlier)),
        of_batch(is_batch) {}

  std::string id;  ///< of the job or batch that has the key
  bool of_batch;
};

/// The store can neither be written nor perhaps read for now: the disk is full or broken. The text says why.
/// The call has changed nothing, and may work later.
class StoreUnavailable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A store that cannot be opened at all; the text names the cause and the remedy.
class CannotOpenStore : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct StoreLimits {
  std::size_t queue = 64;       ///< requests that may wait, a batch being one
  std::size_t keep_bytes = 0;   ///< for what has ended; the job that ended last is kept however large it is
  std::chrono::seconds keep{};  ///< how long what has ended is kept
};

/// A job that a worker has taken to run. Only the holder of the latest attempt may end it.
struct Claim {
  Job job;
  std::shared_ptr<const std::string> problem;  ///< null if what is stored is damaged
  std::uint64_t attempt = 0;
  std::optional<double> predicted_memory = {};  ///< as in NewJob, where the store keeps it
};

/// What is asked for of the jobs, by all that is given.
struct ListQuery {
  std::optional<JobStatus> status = {};
  std::optional<std::string> owner = {};
  std::optional<std::string> tag = {};
  std::optional<std::string> title = {};  ///< a part of it; the case of ASCII letters does not matter
  std::size_t limit = 50;
  std::optional<std::string> after = {};  ///< only jobs that are older than this id
};

/// Of so many jobs at most a list reads the titles; a search goes on with its next page.
constexpr std::size_t titles_of_a_page = 10'000;

struct JobPage {
  std::vector<Job> jobs;                 ///< newest first, perhaps fewer than the limit
  std::optional<std::string> next = {};  ///< what is older than this id is on the next page; none on the last
};

/// The page of jobs of which one more than the limit was looked for. `read_to` is where a search by title
/// ended before the end.
inline JobPage page_of(std::vector<Job> jobs, std::size_t limit, std::optional<std::string> read_to) {
  if (jobs.size() > limit) {
    jobs.pop_back();
    read_to = jobs.back().id;
  }
  return {std::move(jobs), std::move(read_to)};
}

using JobCounts = std::map<JobStatus, std::size_t>;

/// What came of the wish to cancel a job.
enum class Cancellation {
  none,   ///< it has ended, or there is none
  ended,  ///< it was queued, and is `cancelled` now
  asked,  ///< it runs; it is not queued again whatever happens to its worker
};

class Fleet;

/// Keeps jobs. Every call is one step that is done as a whole or not at all, whatever other threads call. A
/// step that has returned is kept as safely as the store keeps anything. Every call may throw
/// StoreUnavailable.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// Takes a new job as `queued` and returns its id; or what earlier() finds. Throws QueueFull and KeyReused.
  virtual std::string add(NewJob job) = 0;

  /// The id of the job that came from this owner with this key and the same problem before. Throws KeyReused
  /// if it was another problem.
  virtual std::optional<std::string> earlier(const std::string& owner, const std::string& key,
                                             const std::string& problem) = 0;

  /// Takes all jobs of a new batch, or none, and returns it; or what earlier_batch() finds. Throws QueueFull
  /// if not all may wait, and KeyReused.
  virtual Batch add(NewBatch batch) = 0;

  /// The batch that came from this owner with this key and the same request before. Throws KeyReused if it
  /// was something else.
  virtual std::optional<Batch> earlier_batch(const std::string& owner, const std::string& key,
                                             const std::string& digest) = 0;

  /// Turns the oldest queued job into `running`. Survives the end of the process, perhaps not that of the
  /// machine.
  virtual std::optional<Claim> claim() = 0;

  /// Ends a running job, and drops what is beyond the limits. False if the attempt is no longer the job's.
  virtual bool finish(const Claim& claim, const Ending& ending) = 0;

  /// Queues a running job again, as if it had not been claimed. False if the attempt is no longer the job's,
  /// or if it is to be cancelled.
  virtual bool give_back(const Claim& claim) = 0;

  virtual Cancellation cancel(const std::string& id) = 0;

  /// Removes a job that has ended. False if there is none.
  virtual bool remove_ended(const std::string& id) = 0;

  /// Removes those of the jobs that have ended, in one step. Returns how many.
  virtual std::size_t remove_ended(std::span<const std::string> ids) = 0;

  /// Drops some of the jobs that ended too long ago, if there are any, and gives back room that nobody needs;
  /// a step that is short.
  virtual void tidy() = 0;

  virtual std::optional<Job> find(const std::string& id) const = 0;
  virtual JobPage list(const ListQuery& query) const = 0;

  /// The ids of all jobs that a list would have, in pages without an end; newest first.
  virtual std::vector<std::string> ids(const ListQuery& query) const = 0;

  /// How many jobs there are of each status that any job has.
  virtual JobCounts count() const = 0;

  /// A batch, as long as any of its jobs is there.
  virtual std::optional<Batch> find_batch(const std::string& id) const = 0;

  /// As count(), of the jobs of a batch.
  virtual JobCounts count_of_batch(const std::string& id) const = 0;

  /// Those jobs of a batch that ended at `since` or later, as BatchEnds::latest has it.
  virtual BatchEnds ends_of_batch(const std::string& id, std::int64_t since) const = 0;

  /// The problem of a job, and what was found out once it has ended. If that is damaged, the job is `failed`
  /// from now on, and has no solution.
  virtual std::optional<JobResult> result(const std::string& id) = 0;

  /// About how many bytes of memory result() takes for the one who calls it; 0 where he shares what the store
  /// has.
  virtual std::size_t result_memory(const std::string& id) const = 0;

  /// How many jobs are kept as `failed` because what was stored of them is damaged.
  virtual std::size_t damaged() const = 0;

  /// Why nothing can be written for now; nothing if it can. Tries it if the last write failed.
  virtual std::optional<std::string> trouble() = 0;

  /// Whether the jobs are still there when the process has ended.
  virtual bool outlives_process() const = 0;

  /// What its processes tell each other, if several may use the store at the same time; else null.
  virtual Fleet* fleet() { return nullptr; }
};

}  // namespace signorini::server
