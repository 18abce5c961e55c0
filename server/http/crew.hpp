#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace signorini::server {

/// Threads that do what they are given, in the order in which it comes. Only a few are at work at the same
/// time, for more would but take turns on the cores and be done later, all of them; but one that waits for a
/// client or a solve is not at work, and another takes its place.
class Crew {
 public:
  /// `threads` in all, `at_work` at the same time.
  Crew(std::size_t threads, std::size_t at_work);
  ~Crew();

  Crew(const Crew&) = delete;
  Crew& operator=(const Crew&) = delete;

  void enqueue(std::function<void()> task);

  /// Returns when everything that was enqueued is done.
  void shutdown();

  /// While it lives, its thread waits for something. Does nothing outside a crew.
  class Rest {
   public:
    Rest();
    ~Rest();

    Rest(const Rest&) = delete;
    Rest& operator=(const Rest&) = delete;
  };

 private:
  void work();
  void leave_work();
  void return_to_work();

  const std::size_t most_at_work_;
  std::mutex mutex_;
  std::condition_variable may_work_;
  std::deque<std::function<void()>> tasks_;
  std::size_t at_work_ = 0;
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace signorini::server
