#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include "progress/executor.hpp"

namespace signorini {

/// An executor of so many threads, that of the caller among them, which are there whether there are cores for
/// them or not.
class Threads : public Executor {
 public:
  explicit Threads(int count) : count_(count) {}

  void run(int count, const std::function<void(int)>& work, const std::function<void()>& waiting) override {
    std::atomic<int> next = 0, helping = count_ - 1;
    const auto take_part = [&] {
      for (int number = next++; number < count; number = next++) work(number);
    };
    std::vector<std::thread> helpers;
    for (int i = 1; i < count_; ++i)
      helpers.emplace_back([&] {
        take_part();
        --helping;
      });
    take_part();
    while (helping > 0) {
      waiting();
      std::this_thread::yield();
    }
    for (std::thread& helper : helpers) helper.join();
  }

 private:
  const int count_;
};

}  // namespace signorini
