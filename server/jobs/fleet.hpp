#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/jobs/live_solve.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

/// What a worker would run next.
struct Wish {
  double memory = std::numeric_limits<double>::infinity();  ///< bytes that the solve may be predicted to take
  double most_memory = memory;                              ///< the same when nothing else runs here
  std::vector<std::int64_t> operators =
      {};  ///< marks of those that are at hand: their jobs come first, for a while
};

/// A claim that its runner works on, and how far it is.
struct Heartbeat {
  std::string job;
  std::uint64_t attempt = 0;
  std::size_t told = 0;  ///< iterations that earlier heartbeats told
  Advance advance;       ///< with the iterations since then
};

/// What has become of a claim.
enum class Standing {
  held,
  to_be_cancelled,  ///< it is held, and somebody wishes its end
  lost,             ///< somebody else may have the job
};

/// A job that somebody waits for, and what he knows of it.
struct Sought {
  std::string job;
  std::uint64_t attempt = 0;  ///< the last one that he has seen; 0: none
  std::size_t known = 0;      ///< its iterations that he has seen
  bool iterations = true;     ///< whether he wants them
};

/// A job that was sought. One that is nowhere is not found.
struct Found {
  std::string job;
  JobStatus status = JobStatus::queued;
  std::uint64_t attempt = 0;  ///< the last one; 0: none
  std::optional<Time> started;
  Advance advance;  ///< with the iterations that are wanted and not known yet; all, if the attempt is another
};

/// Entries of a sweep that are to be a job of their own.
struct NewChunk {
  std::size_t first = 0, count = 0;
  std::string problem;  ///< that has them alone as its sweep
  double predicted_memory = 0;
};

/// How far a chunk is.
struct ChunkStanding {
  std::string job;
  std::size_t first = 0, count = 0;
  JobStatus status = JobStatus::queued;
  std::size_t swept = 0;     ///< entries that are done, while it runs
  bool is_given_up = false;  ///< too many died with it
};

/// What processes with one store tell each other by it. Each claim is a lease: whoever does not renew it
/// loses it, and the job is claimed by somebody else, under a greater number of attempt. Nothing is accepted
/// of the loser from then on. Every call may throw StoreUnavailable.
class Fleet {
 public:
  virtual ~Fleet() = default;

  /// As JobStore::claim(), of a job that fits the wish.
  virtual std::optional<Claim> claim(const Wish& wish) = 0;

  /// How long a claim is held without being renewed.
  virtual std::chrono::milliseconds lease() const = 0;

  /// Renews claims; what has become of each.
  virtual std::vector<Standing> renew(std::span<const Heartbeat> heartbeats) = 0;

  /// Takes jobs from runners that have not renewed their lease: they are queued again, or end.
  virtual void rescue() = 0;

  virtual std::vector<Found> look(std::span<const Sought> sought) const = 0;

  /// Queues entries of a claimed job's sweep as jobs that everybody may claim and nobody lists. They are gone
  /// when the whole has ended, and asked to end when that is. False if the claim is lost.
  virtual bool split(const Claim& whole, std::span<const NewChunk> chunks) = 0;

  /// The chunks of a job, which an earlier attempt may have made, in their order.
  virtual std::vector<ChunkStanding> chunks(const std::string& whole) const = 0;

  /// Takes a chunk that nobody has taken yet. For the runner of the whole: it takes no memory beside that.
  virtual std::optional<Claim> claim_chunk(const std::string& whole) = 0;

  /// What a chunk that has ended found; empty if nothing, or if that is damaged.
  virtual std::vector<SweepEntry> entries(const std::string& chunk) const = 0;

  /// Tells the others that there may be something to claim, or to look at. Nobody relies on being told.
  virtual void hint() = 0;

  /// Waits until somebody hints, or so long. False if nobody did.
  virtual bool wait_for_hint(std::chrono::milliseconds time) = 0;

  /// How often something was not accepted because it came under a claim that was lost.
  virtual std::uint64_t stale_writes() const = 0;
};

}  // namespace signorini::server
