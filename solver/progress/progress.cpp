#include "progress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
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
  found_.reset();
  check();
}

/// One that is completed again beyond the limit gets no more time.
void Progress::found() {
  const bool is_in_time = time_left_to_iterate() > 0;
  if (!found_ || is_in_time) found_ = seconds();
}

void Progress::check() {
  if (!observer_.keep_going()) throw Cancelled();
  if (time_left().value_or(1) > 0) return;
  throw TimeUp("the time limit of " + std::to_string(*time_limit_) + " s was reached in the phase '" +
               name(phase_) + "', before " +
               (found_ ? "the fields of an iterate were known" : "there was any iterate") +
               ": raise solver.time_limit or coarsen the mesh");
}

double Progress::time_left_to_iterate() const {
  return time_limit_ ? *time_limit_ - spent_before_ - seconds() : std::numeric_limits<double>::infinity();
}

std::optional<double> Progress::time_left() const {
  if (!time_limit_) return std::nullopt;
  const double to_iterate = time_left_to_iterate();
  if (phase_ == Phase::certify) return to_iterate + for_answer_;
  return found_ ? std::max(to_iterate, *found_ + for_answer_ - seconds()) : to_iterate;
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
  // To complete an iterate takes no longer than what led to the first one, mostly.
  const double to_complete = std::min(entered_, seconds() - entered_);
  return time_left_to_iterate() > to_complete;
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
