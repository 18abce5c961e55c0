#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "progress/helpers.hpp"
#include "result/solution.hpp"
#include "server/jobs/fleet.hpp"
#include "server/jobs/live_solve.hpp"

namespace signorini::server {

/// What the runner of a shared sweep asks of the process that it is in.
struct SweepHost {
  std::function<void(const Claim& chunk)> hold;    ///< renews the claim from now on
  std::function<void(const Claim& chunk)> let_go;  ///< no more
  std::function<void()> tell;                      ///< the others that there is something to claim
  std::function<void()> wait;                      ///< a moment, or until there are news
};

/// A long sweep that the workers of a fleet solve together. The one that has claimed the job solves the
/// problem itself and some entries, sees how long they take, and splits the rest into chunks: jobs that
/// anybody claims in turn, himself too. Their entries come back by the database, in whatever order. Each
/// chunk begins with an entry that owes nothing to those before it, so that every number is what one worker
/// would find.
///
/// Whoever dies with a chunk loses that alone. If it is the one with the whole, the next one finds the chunks
/// that there are.
class SharedSweep : public Helpers {
 public:
  SharedSweep(Fleet& fleet, JobStore& store, const Claim& claim, LiveSolve& live, SweepHost host);

  std::size_t join(std::size_t next, const FindStarts& starts) override;
  std::vector<SweepEntry> solve(std::size_t first, const SolveEntries& here) override;

 private:
  using Clock = std::chrono::steady_clock;

  void find_again();
  void split(std::size_t next, const FindStarts& starts);
  void solve_chunk(const Claim& claim, const SolveEntries& here);
  void give_back(const Claim& claim);
  void gather(const SolveEntries& here);
  void tell(std::size_t done_here);

  Fleet& fleet_;
  JobStore& store_;
  const Claim& claim_;
  LiveSolve& live_;
  const SweepHost host_;
  const Clock::time_point begin_ = Clock::now();
  std::optional<Clock::time_point> entries_begin_;
  Clock::time_point look_again_;  ///< whether it is worth it
  std::vector<ChunkStanding> chunks_;
  std::map<std::size_t, std::vector<SweepEntry>> found_;  ///< by their first entry
  std::size_t entries_ = 0;                               ///< of the whole sweep
  Clock::time_point looked_;                              ///< at what others have done
  std::size_t done_elsewhere_ = 0, told_ = 0;
};

}  // namespace signorini::server
