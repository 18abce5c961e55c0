#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "progress/observer.hpp"
#include "server/jobs/job.hpp"

namespace signorini::server {

/// How far a solve is.
struct Progress {
  std::optional<Phase> phase;
  int iteration = 0;
  std::optional<double> residual;      ///< relative; see residual()
  std::optional<Level> level;          ///< the last mesh that was solved, of one that refines itself
  std::size_t swept = 0, sweep = 0;    ///< entries of a sweep that are done, and all of them
  std::size_t studied = 0, study = 0;  ///< the same for the runs of a study
};

/// The residual by which the method stops: the paper's criterion in its form, else the largest of the
/// relative contact residuals.
double residual(const Iteration& iteration);

/// How far a solve is, and iterations that it has done until then.
struct Advance {
  Progress progress;
  std::vector<Iteration> iterations;
};

/// A solve that runs: written by its worker, read by everybody.
class LiveSolve : public Observer {
 public:
  explicit LiveSolve(Time started) : started_(started) {}

  void entered(Phase phase) override;
  void iterated(const Iteration& iteration) override;
  void refined(const Level& level, const Solution& solution) override;
  void swept(std::size_t done, std::size_t count) override;
  void studied(std::size_t done, std::size_t count) override;
  bool keep_going() override { return !cancelled_; }

  void cancel() { cancelled_ = true; }

  /// Ends it at its next check, for somebody else may solve the job by now.
  void lose() { lost_ = cancelled_ = true; }
  bool is_lost() const { return lost_; }

  /// Takes over how far a solve is that another process runs, and what it has iterated since the last time,
  /// as far as that is asked for.
  void follow(const Advance& advance);

  Progress progress() const;
  std::size_t iterations() const;
  std::vector<Iteration> history() const;
  /// At most so many iterations after the first ones.
  std::vector<Iteration> history_after(std::size_t first, std::size_t most) const;
  /// Both at one moment: no iteration is of a later phase than the one that is told.
  Advance advance_after(std::size_t first, std::size_t most) const;

  /// When it was started, which tells it from another solve of the same job.
  Time started() const { return started_; }

 private:
  Progress progress_now() const;
  std::vector<Iteration> history_now(std::size_t first, std::size_t most) const;

  const Time started_;
  std::atomic<bool> cancelled_ = false, lost_ = false;
  mutable std::mutex mutex_;
  std::optional<Phase> phase_;
  std::optional<Level> level_;
  std::vector<Iteration> history_;
  int iteration_ = 0;               ///< that was taken over, where the history was not
  std::optional<double> residual_;  ///< of it
  std::size_t swept_ = 0, sweep_ = 0;
  std::size_t studied_ = 0, study_ = 0;
};

}  // namespace signorini::server
