#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <utility>

#include "progress/progress.hpp"

namespace signorini {

/// Calls work(0, progress), …, work(count − 1, progress), which the executor of the progress does at the same
/// time if there is one. Each call is given the progress of its thread, and changes nothing that another one
/// reads or changes.
///
/// Throws what the work throws, of several calls what the first one does, and what Progress::check() throws.
void side_by_side(int count, Progress& progress, const std::function<void(int, Progress&)>& work);

/// Those numbers of a loop from `begin` on, without `end`.
struct Part {
  int begin, end;
};

/// Of the numbers that a part has: a millisecond where a triangle has little to do, which is many times what
/// a part has to prepare. Where it has much, the last part of a helper that others keep from its core is
/// waited for.
inline constexpr int kPart = 1 << 11;

/// Goes through 0, …, count − 1 in parts, side by side. What the parts are depends on the count alone, so
/// that what they find is the same to the last bit whoever does them.
void in_parts(int count, Progress& progress, const std::function<void(Part, Progress&)>& work);

/// Lets the parts of a loop do something in their order, one at a time.
class Turns {
 public:
  /// That of a part. If it ends before it has come, those behind it have none.
  class Turn {
   public:
    Turn(Turns& all, Part part) : all_(all), part_(part) {}
    ~Turn();

    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

    /// Waits until those before it are done; false if one of them has failed.
    bool come();
    void done();

   private:
    Turns& all_;
    const Part part_;
    bool is_done_ = false;
  };

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int next_ = 0;
  bool is_broken_ = false;
};

/// The same with what the parts find, found = find(part, progress), which is added in their order, one at a
/// time: add(found).
template <typename Find, typename Add>
void in_parts(int count, Progress& progress, const Find& find, const Add& add) {
  Turns turns;
  in_parts(count, progress, [&](Part part, Progress& own) {
    Turns::Turn turn(turns, part);
    auto found = find(part, own);
    if (!turn.come()) return;
    add(std::move(found));
    turn.done();
  });
}

}  // namespace signorini
