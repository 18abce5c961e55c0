#include "progress.hpp"

#include <cmath>
#include <string>

#include "progress/overflow.hpp"

namespace signorini {

const char* name(Phase phase) {
  static constexpr std::array names{"mesh", "assemble", "factorize", "iterate", "certify"};
  return names[static_cast<int>(phase)];
}

void Progress::enter(Phase phase) {
  const double now = seconds();
  spent_[static_cast<int>(phase_)] += now - entered_;
  entered_ = now;
  phase_ = phase;
  observer_.entered(phase);
  found_ = false;
  check();
}

void Progress::check() {
  if (!observer_.keep_going()) throw Cancelled();
  if (!found_ && !in_time())
    throw TimeUp("the time limit of " + std::to_string(*time_limit_) + " s was reached in the phase '" +
                 name(phase_) +
                 "', before there was any iterate: raise solver.time_limit or coarsen the mesh");
}

std::optional<double> Progress::time_left() const {
  if (!time_limit_) return std::nullopt;
  return *time_limit_ + (phase_ == Phase::certify ? kForBound : 0) - spent_before_ - seconds();
}

bool Progress::record(Iteration iteration) {
  iteration.number = taken_ + iterations() + 1;
  iteration.seconds = seconds();
  for (const double residual :
       {iteration.displacement_change.value_or(0), iteration.clearance_change, iteration.equilibrium,
        iteration.penetration, iteration.tension, iteration.complementarity})
    if (!std::isfinite(residual)) throw Overflow();
  history_.push_back(iteration);
  observer_.iterated(iteration);
  if (!observer_.keep_going()) throw Cancelled();
  return in_time();
}

Level Progress::refined(Level level, const Solution& solution) {
  level.seconds = seconds();
  observer_.refined(level, solution);
  return level;
}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double Progress::seconds_in(Phase phase) const {
  const double running = phase == phase_ ? seconds() - entered_ : 0;
  return spent_[static_cast<int>(phase)] + running;
}

}  // namespace signorini
