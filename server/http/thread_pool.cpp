#include "server/http/thread_pool.hpp"

#include <utility>

namespace signorini::server {
namespace {

thread_local ThreadPool* own_pool = nullptr;

}  // namespace

ThreadPool::ThreadPool(std::size_t threads, std::size_t at_work) : most_at_work_(at_work) {
  for (std::size_t i = 0; i < threads; ++i) threads_.emplace_back(&ThreadPool::work, this);
}

ThreadPool::~ThreadPool() {
  shutdown();
}

void ThreadPool::enqueue(Task task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.add(std::move(task));
  }
  may_work_.notify_one();
}

void ThreadPool::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  may_work_.notify_all();
  for (std::thread& thread : std::exchange(threads_, {})) thread.join();
}

void ThreadPool::work() {
  own_pool = this;
  std::unique_lock lock(mutex_);
  for (;;) {
    may_work_.wait(lock, [this] { return tasks_.empty() ? ending_ : at_work_ < most_at_work_; });
    if (tasks_.empty()) return;
    std::vector<Task> unwanted = unwanted_now_and_then();
    std::optional<Task> task = tasks_.take();
    ++at_work_;
    lock.unlock();
    unwanted.clear();
    if (task && !(task->is_unwanted && task->is_unwanted())) task->work();
    task.reset();
    lock.lock();
    --at_work_;
    if (ending_ && tasks_.empty()) may_work_.notify_all();
  }
}

/// What they hold is given back soon, also by those whose turn is far.
std::vector<Task> ThreadPool::unwanted_now_and_then() {
  constexpr std::chrono::milliseconds between_looks{250};
  const auto now = Clock::now();
  if (now < look_again_) return {};
  look_again_ = now + between_looks;
  return tasks_.take_unwanted();
}

void ThreadPool::leave_work() {
  {
    const std::lock_guard lock(mutex_);
    --at_work_;
  }
  may_work_.notify_one();
}

/// At once, even if more are at work then: a task that was begun is to end.
void ThreadPool::return_to_work() {
  const std::lock_guard lock(mutex_);
  ++at_work_;
}

ThreadPool::Waiting::Waiting() {
  if (own_pool != nullptr) own_pool->leave_work();
}

ThreadPool::Waiting::~Waiting() {
  if (own_pool != nullptr) own_pool->return_to_work();
}

}  // namespace signorini::server
