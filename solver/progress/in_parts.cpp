#include "progress/in_parts.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "progress/executor.hpp"
#include "progress/memory_meter.hpp"

namespace signorini {
namespace {

/// Of a helper's thread.
class UntilEnded : public Observer {
 public:
  explicit UntilEnded(const std::atomic<bool>& ended) : ended_(ended) {}
  bool keep_going() override { return !ended_; }

 private:
  const std::atomic<bool>& ended_;
};

/// Work that several threads do for the solve of one.
class SharedWork {
 public:
  SharedWork(Progress& progress, const std::function<void(int, Progress&)>& work)
      : progress_(progress), work_(work) {}

  void run(int count, Executor& executor) {
    {
      MemoryOfHelpers memory;
      memory_ = &memory;
      executor.run(
          count, [this](int number) { run(number); }, [this] { look(); });
    }
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  /// Before all calls.
  static constexpr int kFirst = -1;

  /// Calls that have begun go on when another one fails, for theirs may be the first failure.
  void run(int number) {
    if (failed_) return;
    try {
      if (std::this_thread::get_id() == caller_)
        work_(number, progress_);
      else
        help(number);
    } catch (const Cancelled&) {
      end(number);
    } catch (const TimeUp&) {
      end(number);
    } catch (...) {
      fail(number);
    }
  }

  void help(int number) {
    const MemoryOfHelpers::Share share(*memory_);
    UntilEnded observer(ended_);
    Progress own(observer, std::nullopt);
    work_(number, own);
  }

  void look() {
    if (ended_) return;
    try {
      progress_.check();
    } catch (...) {
      end(kFirst);
    }
  }

  /// By the observer or the clock, of whom only the thread of the caller knows.
  void end(int number) {
    if (std::this_thread::get_id() != caller_) return;
    ended_ = true;
    fail(number);
  }

  void fail(int number) {
    const std::lock_guard lock(mutex_);
    failed_ = true;
    if (failure_ && first_failed_ <= number) return;
    first_failed_ = number;
    failure_ = std::current_exception();
  }

  Progress& progress_;
  const std::function<void(int, Progress&)>& work_;
  const std::thread::id caller_ = std::this_thread::get_id();
  MemoryOfHelpers* memory_ = nullptr;
  std::atomic<bool> failed_ = false, ended_ = false;
  std::mutex mutex_;
  std::exception_ptr failure_;
  int first_failed_ = 0;
};

}  // namespace

void side_by_side(int count, Progress& progress, const std::function<void(int, Progress&)>& work) {
  if (count > 1 && progress.executor() != nullptr)
    return SharedWork(progress, work).run(count, *progress.executor());
  for (int number = 0; number < count; ++number) work(number, progress);
}

void in_parts(int count, Progress& progress, const std::function<void(Part, Progress&)>& work) {
  side_by_side((count - 1) / kPart + (count > 0), progress, [&](int number, Progress& own) {
    const int begin = number * kPart;
    work({begin, std::min(count, begin + kPart)}, own);
  });
}

bool Turns::Turn::come() {
  std::unique_lock lock(all_.mutex_);
  all_.changed_.wait(lock, [this] { return all_.is_broken_ || all_.next_ == part_.begin; });
  return !all_.is_broken_;
}

void Turns::Turn::done() {
  const std::lock_guard lock(all_.mutex_);
  all_.next_ = part_.end;
  is_done_ = true;
  all_.changed_.notify_all();
}

Turns::Turn::~Turn() {
  if (is_done_) return;
  const std::lock_guard lock(all_.mutex_);
  all_.is_broken_ = true;
  all_.changed_.notify_all();
}

}  // namespace signorini
