#include "server/idle_cores.hpp"

#include <chrono>

namespace signorini::server {
namespace {

/// A solve that waits for its helpers looks so often whether it is cancelled.
constexpr std::chrono::milliseconds kLook{5};
/// Most pieces take a millisecond. One that is half of a certificate takes seconds, in which it shares its
/// core: who has just begun must hear cancels.
constexpr std::chrono::milliseconds kPatience{20};

}  // namespace

IdleCores::IdleCores(int cores, const std::function<void()>& begin) : cores_(cores) {
  for (int i = 1; i < cores; ++i)
    threads_.emplace_back([this, begin] {
      begin();
      help();
    });
}

IdleCores::~IdleCores() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool IdleCores::may_help() const {
  return !shared_.empty() && solves_ + helpers_ < cores_;
}

/// The number of the next call.
int IdleCores::begin(Shared& shared) {
  const int number = shared.begun++;
  if (shared.begun == shared.count) shared_.remove(&shared);
  return number;
}

void IdleCores::help() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ends_ || may_help(); });
    if (ends_) return;
    Shared& own = *shared_.front();
    const int number = begin(own);
    ++helpers_;
    ++own.helpers;
    lock.unlock();
    own.work(number);
    lock.lock();
    --own.helpers;
    --helpers_;
    left_.notify_all();
  }
}

void IdleCores::run(int count, const std::function<void(int)>& work, const std::function<void()>& waiting) {
  if (count == 0) return;
  Shared own{work, count};
  std::unique_lock lock(mutex_);
  shared_.push_back(&own);
  if (may_help()) changed_.notify_all();
  while (own.begun < count) {
    const int number = begin(own);
    lock.unlock();
    work(number);
    lock.lock();
  }
  while (!left_.wait_for(lock, kLook, [&own] { return own.helpers == 0; })) {
    lock.unlock();
    waiting();
    lock.lock();
  }
}

IdleCores::Solve::Solve(IdleCores& cores) : cores_(cores) {
  std::unique_lock lock(cores_.mutex_);
  ++cores_.solves_;
  cores_.left_.wait_for(lock, kPatience, [this] {
    return cores_.helpers_ == 0 || cores_.solves_ + cores_.helpers_ <= cores_.cores_;
  });
}

IdleCores::Solve::~Solve() {
  {
    const std::lock_guard lock(cores_.mutex_);
    --cores_.solves_;
  }
  cores_.changed_.notify_all();
}

}  // namespace signorini::server
