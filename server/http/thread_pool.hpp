#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <vector>

#include "server/http/turns.hpp"

namespace signorini::server {

/// Threads that do what they are given, sender by sender in turn. Only a few are at work at the same time,
/// for more would but take turns on the cores and be done later, all of them; but one that waits for a client
/// or a solve is not at work, and another takes its place. What a client has left behind is not begun.
class ThreadPool {
 public:
  /// `threads` in all, `at_work` at the same time.
  ThreadPool(std::size_t threads, std::size_t at_work);
  ~ThreadPool();

  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  void enqueue(Task task);

  /// Returns when everything that was enqueued is done.
  void shutdown();

  /// While it lives, its thread waits for something. Does nothing outside a pool.
  class Waiting {
   public:
    Waiting();
    ~Waiting();

    Waiting(const Waiting&) = delete;
    Waiting& operator=(const Waiting&) = delete;
  };

 private:
  using Clock = std::chrono::steady_clock;

  void work();
  std::vector<Task> unwanted_now_and_then();
  void leave_work();
  void return_to_work();

  const std::size_t most_at_work_;
  std::mutex mutex_;
  std::condition_variable may_work_;
  Turns tasks_;
  Clock::time_point look_again_ = {};  ///< for tasks whose clients have left
  std::size_t at_work_ = 0;
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace signorini::server
