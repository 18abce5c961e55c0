#include "server/jobs/live_solve.hpp"

#include <algorithm>

namespace signorini::server {

double residual(const Iteration& iteration) {
  if (iteration.displacement_change) return *iteration.displacement_change;
  return std::max({iteration.penetration, iteration.tension, iteration.complementarity});
}

void LiveSolve::entered(Phase phase) {
  const std::lock_guard lock(mutex_);
  phase_ = phase;
}

void LiveSolve::iterated(const Iteration& iteration) {
  const std::lock_guard lock(mutex_);
  history_.push_back(iteration);
}

void LiveSolve::refined(const Level& level, const Solution&) {
  const std::lock_guard lock(mutex_);
  level_ = level;
}

void LiveSolve::swept(std::size_t done, std::size_t count) {
  const std::lock_guard lock(mutex_);
  swept_ = done;
  sweep_ = count;
}

void LiveSolve::studied(std::size_t done, std::size_t count) {
  const std::lock_guard lock(mutex_);
  studied_ = done;
  study_ = count;
}

void LiveSolve::follow(const Advance& advance) {
  const auto& [progress, iterations] = advance;
  const std::lock_guard lock(mutex_);
  phase_ = progress.phase;
  level_ = progress.level;
  swept_ = progress.swept;
  sweep_ = progress.sweep;
  studied_ = progress.studied;
  study_ = progress.study;
  iteration_ = progress.iteration;
  residual_ = progress.residual;
  history_.insert(history_.end(), iterations.begin(), iterations.end());
}

Progress LiveSolve::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_now();
}

Progress LiveSolve::progress_now() const {
  Progress progress;
  progress.phase = phase_;
  progress.level = level_;
  progress.swept = swept_;
  progress.sweep = sweep_;
  progress.studied = studied_;
  progress.study = study_;
  progress.iteration = iteration_;
  progress.residual = residual_;
  if (!history_.empty()) {
    progress.iteration = history_.back().number;
    progress.residual = residual(history_.back());
  }
  return progress;
}

std::size_t LiveSolve::iterations() const {
  const std::lock_guard lock(mutex_);
  return history_.size();
}

std::vector<Iteration> LiveSolve::history() const {
  const std::lock_guard lock(mutex_);
  return history_;
}

std::vector<Iteration> LiveSolve::history_after(std::size_t first, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  return history_now(first, most);
}

Advance LiveSolve::advance_after(std::size_t first, std::size_t most) const {
  const std::lock_guard lock(mutex_);
  return {progress_now(), history_now(first, most)};
}

std::vector<Iteration> LiveSolve::history_now(std::size_t first, std::size_t most) const {
  const std::size_t begin = std::min(first, history_.size());
  const std::size_t end = begin + std::min(most, history_.size() - begin);
  return {history_.begin() + static_cast<std::ptrdiff_t>(begin),
          history_.begin() + static_cast<std::ptrdiff_t>(end)};
}

}  // namespace signorini::server
