#pragma once

#include <condition_variable>
#include <list>
#include <mutex>
#include <thread>
#include <vector>

#include "progress/executor.hpp"

namespace signorini::server {

/// The cores that no solve occupies help those that run: a thread for each core but one, which are at work
/// only while solves and they together have no more than the cores. A solve that begins has its core back as
/// soon as a helper has done the piece that it is at, and waits for that, but not for long.
class IdleCores : public Executor {
 public:
  /// Each thread begins with what is given. It should leave it no less time than the solves have, who wait
  /// for it.
  explicit IdleCores(
      int cores, const std::function<void()>& begin = [] {});
  ~IdleCores() override;

  IdleCores(const IdleCores&) = delete;
  IdleCores& operator=(const IdleCores&) = delete;

  /// That are at work in one solve at most: its own, and the helpers.
  int threads() const { return cores_; }

  void run(int count, const std::function<void(int)>& work, const std::function<void()>& waiting) override;

  /// A solve on this thread, which occupies a core while it lives.
  class Solve {
   public:
    explicit Solve(IdleCores& cores);
    ~Solve();

    Solve(const Solve&) = delete;
    Solve& operator=(const Solve&) = delete;

   private:
    IdleCores& cores_;
  };

 private:
  /// Work whose owner, on its own thread, waits until nobody is at it.
  struct Shared {
    const std::function<void(int)>& work;
    const int count;
    int begun = 0, helpers = 0;
  };

  int begin(Shared& shared);
  void help();
  bool may_help() const;

  const int cores_;
  std::mutex mutex_;
  std::condition_variable changed_;  ///< something is shared, or a core is free, or all ends
  std::condition_variable left_;     ///< a helper has done its piece
  std::list<Shared*> shared_;        ///< what nobody has begun the last of, the oldest first
  int solves_ = 0, helpers_ = 0;     ///< at work
  bool ends_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace signorini::server
