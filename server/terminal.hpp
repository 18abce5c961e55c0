#pragma once

#include <chrono>
#include <string>

#include "progress/observer.hpp"

namespace signorini::server {

/// Whether the standard output, or the standard error, is a terminal.
bool writes_to_terminal();
bool reports_to_terminal();

/// Shows how far a solve is in the last line of a terminal on standard error, some times a second, and each
/// level of a mesh that refines itself in a line that stays. Shows nothing where standard error is no
/// terminal.
class TerminalProgress {
 public:
  /// `triangles`: of the mesh, about.
  explicit TerminalProgress(std::int64_t triangles);
  /// Takes the line away.
  ~TerminalProgress();

  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  void entered(Phase phase);
  void iterated(const Iteration& iteration);
  void refined(const Level& level);
  void done(const char* what, std::size_t done, std::size_t count);
  /// Seconds go on.
  void show_now_and_then();

 private:
  using Clock = std::chrono::steady_clock;

  std::string line() const;
  double seconds() const;

  const bool shows_;
  const Clock::time_point begun_ = Clock::now();
  Clock::time_point shown_ = begun_;
  std::int64_t triangles_;
  Phase phase_ = Phase::mesh;
  int iteration_ = 0;
  std::string parts_;  ///< of a sweep or a study, those that are done
};

}  // namespace signorini::server
