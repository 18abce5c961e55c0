#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <utility>
#include <vector>

#include "observer.hpp"

namespace signorini {

class Executor;

/// The running record of one solve: phases and their seconds, iterations and levels, the two things that may
/// end it early, the observer and the clock, and who helps it.
class Progress {
 public:
  /// `spent` are seconds that count for the time limit, but were before the start. The executor may be null.
  Progress(Observer& observer, std::optional<double> time_limit, double spent = 0,
           Executor* executor = nullptr)
      : observer_(observer), executor_(executor), time_limit_(time_limit), spent_before_(spent) {}

  /// Of a part of a solve, which has a record of its own: its time ends with that of the whole.
  Progress(Observer& observer, const Progress& whole)
      : Progress(observer, whole.time_left(), 0, whole.executor_) {
    for_answer_ = 0;
  }

  Observer& observer() { return observer_; }
  /// Null if nobody helps.
  Executor* executor() const { return executor_; }

  /// Throws Cancelled if the observer ends the solve, TimeUp if the time is up.
  void enter(Phase phase);

  /// There is an iterate to be completed, for which there is a little time beyond the limit.
  void found();

  /// Throws like enter().
  void check();

  /// To be called for every triangle of a long loop; asks every few hundred, for the data of one may take a
  /// tenth of a millisecond to be looked at. Throws like enter().
  void check_in(int triangle) {
    if (triangle % 256 == 0) check();
  }

  /// Numbers and dates the record of an iteration, keeps it and shows it to the observer. Returns false
  /// when the time is nearly up, so that the iterate can be completed; throws Cancelled.
  bool record(Iteration iteration);

  /// Dates the record of a level and shows it with its solution to the observer.
  Level refined(Level level, const Solution& solution);

  /// Iterations since the history was last taken; their numbers run on.
  int iterations() const { return static_cast<int>(history_.size()); }
  std::vector<Iteration> take_history() {
    taken_ += iterations();
    return std::exchange(history_, {});
  }

  /// Seconds since the start, and those spent in a phase so far.
  double seconds() const;
  double seconds_in(Phase phase) const;

 private:
  /// Seconds that are left, if there is a time limit: with those for the answer.
  std::optional<double> time_left() const;

  /// To complete an iterate and to certify may go on a little beyond the limit: hardly any time is needed for
  /// the fields and the bound of a small problem whose iteration the limit ended.
  static constexpr double kForAnswer = 0.15;

  /// Till the limit itself.
  double time_left_to_iterate() const;

  Observer& observer_;
  Executor* executor_;
  std::optional<double> time_limit_;
  double for_answer_ = kForAnswer;
  double spent_before_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  Phase phase_ = Phase::mesh;
  std::optional<double> found_;  ///< when an iterate was, in this phase
  double entered_ = 0;
  std::array<double, 5> spent_{};
  std::vector<Iteration> history_;
  int taken_ = 0;
};

}  // namespace signorini
