#include "memory_meter.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

namespace signorini {
namespace {

/// Of a thread.
struct Account {
  std::int64_t now = 0;  ///< what it has allocated less what it has freed, since it began
  std::int64_t peak = 0;
  std::int64_t limit = std::numeric_limits<std::int64_t>::max();
  bool limit_met = false;
};

thread_local constinit Account account;

}  // namespace

MemoryMeter::MemoryMeter() : start_(account.now), peak_around_(account.peak) {
  account.peak = start_;
}

MemoryMeter::~MemoryMeter() {
  account.peak = std::max(account.peak, peak_around_);
}

std::int64_t MemoryMeter::peak() const {
  return account.peak - start_;
}

namespace {

constexpr std::int64_t kNoLimit = std::numeric_limits<std::int64_t>::max();

}  // namespace

MemoryOfHelpers::MemoryOfHelpers()
    : limit_(account.limit == kNoLimit ? kNoLimit : account.limit - account.now) {}

MemoryOfHelpers::~MemoryOfHelpers() {
  for (const auto& [thread, helper] : helpers_) {
    account.now += helper.now;
    account.peak += helper.peak;
  }
  account.limit_met = account.limit_met || limit_met_;
}

MemoryOfHelpers::Share::Share(MemoryOfHelpers& all)
    : all_(all),
      now_before_(account.now),
      peak_before_(account.peak),
      limit_before_(account.limit),
      limit_met_before_(account.limit_met) {
  account = {.limit = all.limit_};
}

MemoryOfHelpers::Share::~Share() {
  const Account own = account;
  account = {now_before_, peak_before_, limit_before_, limit_met_before_};
  const std::lock_guard lock(all_.mutex_);
  Helper& helper = all_.helpers_[std::this_thread::get_id()];
  helper.peak = std::max(helper.peak, helper.now + own.peak);
  helper.now += own.now;
  all_.limit_met_ = all_.limit_met_ || own.limit_met;
}

Unmetered::Unmetered() : before_(account.now) {}

Unmetered::~Unmetered() {
  account.now = before_;
}

void hand_over(std::size_t bytes) {
  account.now -= static_cast<std::int64_t>(bytes);
}

MemoryLimit::MemoryLimit(double bytes) {
  constexpr double as_good_as_none = 1e18;
  if (bytes < as_good_as_none) account.limit = account.now + static_cast<std::int64_t>(bytes);
  account.limit_met = false;
}

MemoryLimit::~MemoryLimit() {
  account.limit = std::numeric_limits<std::int64_t>::max();
}

bool MemoryLimit::was_met() {
  return account.limit_met;
}

}  // namespace signorini

#ifdef SIGNORINI_COUNTS_MEMORY

// The linker takes these for the functions of the C library (--wrap).
extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* old, std::size_t size);
void __real_free(void* memory);
}

namespace signorini {
namespace {

bool is_too_much(std::size_t more) {
  if (more <= static_cast<std::size_t>(account.limit) &&
      account.now <= account.limit - static_cast<std::int64_t>(more))
    return false;
  account.limit_met = true;
  return true;
}

/// Large pages for what is large, where the kernel has some: they are fewer to fault in and to give back.
void ask_for_large_pages(void* memory, std::size_t size) {
  constexpr std::size_t large = std::size_t{4} << 20;
  if (size < large) return;
  static const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  const auto first = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t begin = (first + page - 1) / page * page, end = (first + size) / page * page;
  // Without them it is the same memory.
  static_cast<void>(madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
}

void* counted(void* memory) {
  const std::size_t size = malloc_usable_size(memory);
  account.now += static_cast<std::int64_t>(size);
  account.peak = std::max(account.peak, account.now);
  ask_for_large_pages(memory, size);
  return memory;
}

void count_off(void* memory) {
  account.now -= static_cast<std::int64_t>(malloc_usable_size(memory));
}

}  // namespace
}  // namespace signorini

extern "C" {

void* __wrap_malloc(std::size_t size) {
  return signorini::is_too_much(size) ? nullptr : signorini::counted(__real_malloc(size));
}

void* __wrap_calloc(std::size_t count, std::size_t size) {
  return signorini::is_too_much(count * size) ? nullptr : signorini::counted(__real_calloc(count, size));
}

void* __wrap_realloc(void* old, std::size_t size) {
  if (signorini::is_too_much(size)) return nullptr;
  signorini::count_off(old);
  void* const memory = __real_realloc(old, size);
  return signorini::counted(memory == nullptr && size > 0 ? old : memory), memory;
}

void __wrap_free(void* memory) {
  signorini::count_off(memory);
  __real_free(memory);
}

}  // extern "C"

void* operator new(std::size_t size) {
  for (;;) {
    if (void* const memory = __wrap_malloc(std::max<std::size_t>(size, 1))) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* memory) noexcept {
  __wrap_free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  __wrap_free(memory);
}

#endif
