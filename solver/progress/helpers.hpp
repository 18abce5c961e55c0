#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace signorini {

struct SweepEntry;

/// The entries of a sweep whose solutions owe nothing to entries before them: of those that are still to be
/// solved.
using FindStarts = std::function<std::vector<std::size_t>()>;

/// Solves so many entries from a start on, and tells how many of them are done after each.
using SolveEntries = std::function<std::vector<SweepEntry>(
    std::size_t first, std::size_t count, const std::function<void(std::size_t done)>& told)>;

/// Others who solve entries of a sweep at the same time.
class Helpers {
 public:
  virtual ~Helpers() = default;

  /// From which start on they help; `none` for now. Asked before each entry is solved.
  virtual std::size_t join(std::size_t next, const FindStarts& starts) = 0;
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  /// All entries from there on. `here` solves on this thread. Throws what that throws, and Cancelled.
  virtual std::vector<SweepEntry> solve(std::size_t first, const SolveEntries& here) = 0;
};

}  // namespace signorini
