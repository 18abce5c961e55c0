#pragma once

#include <functional>

namespace signorini {

/// Cores that a solve may use beside its own. The solver starts no thread: who calls it may have some that
/// are idle.
class Executor {
 public:
  virtual ~Executor() = default;

  /// Calls work(0), …, work(count − 1), in this order, each once, on the thread of the caller and at the same
  /// time on others, and returns when all of them have returned. While the caller waits for others it calls
  /// `waiting` every few milliseconds. Neither throws.
  virtual void run(int count, const std::function<void(int)>& work, const std::function<void()>& waiting) = 0;
};

}  // namespace signorini
