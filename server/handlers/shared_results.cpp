#include "server/handlers/shared_results.hpp"

#include <algorithm>
#include <iterator>

#include <malloc.h>

#include "server/http/error.hpp"
#include "server/http/thread_pool.hpp"

namespace signorini::server {
namespace {

/// So little that it is neither counted nor waited for.
constexpr std::size_t small_result = std::size_t{1} << 20;

HttpError too_many_results() {
  return {503,
          {"too-many-results", "Too many large results are being read",
           "Other clients read as many large results as the service has memory for. Ask again when they are "
           "done, "
           "or for less: `fields=summary` is always there."},
          {{"Retry-After", "10"}}};
}

/// What the holder holds; null if it holds none.
template <typename Holder, typename Member>
std::shared_ptr<const Member> part_of(const Holder& holder, const std::shared_ptr<const Member>& member) {
  return member ? std::shared_ptr<const Member>(holder, member.get()) : nullptr;
}

}  // namespace

/// A result with the memory that it takes.
class SharedResults::Held {
 public:
  Held(SharedResults& results, std::shared_ptr<Place> place, const std::string& id, std::size_t bytes)
      : results_(results), place_(std::move(place)), bytes_(bytes) {
    results_.take(bytes_);
    try {
      result_ = results_.store_.result(id);
    } catch (...) {
      results_.give_back(bytes_);
      throw;
    }
  }
  ~Held() {
    result_.reset();
    // Each of many threads may have been the one that read; the allocator would keep as much for each.
    malloc_trim(0);
    results_.give_back(bytes_);
  }

  Held(const Held&) = delete;
  Held& operator=(const Held&) = delete;

  const std::optional<JobResult>& result() const { return result_; }

 private:
  SharedResults& results_;
  const std::shared_ptr<Place> place_;  ///< which others find as long as this is here
  const std::size_t bytes_;
  std::optional<JobResult> result_;
};

SharedResults::SharedResults(JobStore& store, std::size_t max_bytes, std::chrono::milliseconds patience,
                             std::chrono::milliseconds linger)
    : store_(store),
      max_bytes_(max_bytes),
      patience_(patience),
      linger_(linger),
      keeper_([this](const std::stop_token& stop) { let_go(stop); }) {}

std::optional<JobResult> SharedResults::get(const std::string& id) {
  const std::size_t bytes = store_.result_memory(id);
  if (bytes <= small_result) return store_.result(id);
  const std::shared_ptr<Place> place = place_of(id);
  std::unique_lock reading(place->reading, std::try_to_lock);
  if (!reading) {
    const ThreadPool::Waiting rest;
    reading.lock();
  }
  std::shared_ptr<const Held> held = place->held.lock();
  if (!held) place->held = held = std::make_shared<const Held>(*this, place, id, bytes);
  if (!held->result()) return std::nullopt;
  linger(held);
  const auto& [problem, solution, history] = *held->result();
  return JobResult{part_of(held, problem), part_of(held, solution), part_of(held, history)};
}

std::shared_ptr<SharedResults::Place> SharedResults::place_of(const std::string& id) {
  const std::lock_guard lock(mutex_);
  std::erase_if(places_, [](const auto& each) { return each.second.expired(); });
  std::weak_ptr<Place>& known = places_[id];
  if (std::shared_ptr<Place> place = known.lock()) return place;
  const auto place = std::make_shared<Place>();
  known = place;
  return place;
}

void SharedResults::linger(std::shared_ptr<const Held> held) {
  const std::lock_guard lock(mutex_);
  if (awaiting_ > 0) return;
  std::erase_if(lingering_, [&](const Lingering& each) { return each.held == held; });
  lingering_.push_back({std::move(held), std::chrono::steady_clock::now() + linger_});
  lingers_.notify_one();
}

/// What a result gives back needs the mutex, so the last copies of those that are over go without it.
void SharedResults::let_go(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (lingers_.wait(lock, stop, [this] { return !lingering_.empty(); })) {
    const auto until = lingering_.front().until;
    lingers_.wait_until(lock, stop, until, [] { return false; });
    if (stop.stop_requested()) return;
    const auto now = std::chrono::steady_clock::now();
    const auto first_to_stay =
        std::ranges::find_if(lingering_, [&](const Lingering& each) { return each.until > now; });
    std::vector<Lingering> over(std::make_move_iterator(lingering_.begin()),
                                std::make_move_iterator(first_to_stay));
    lingering_.erase(lingering_.begin(), first_to_stay);
    lock.unlock();
    over.clear();
    lock.lock();
  }
}

void SharedResults::take(std::size_t bytes) {
  std::unique_lock lock(mutex_);
  const auto fits = [&] { return taken_ == 0 || taken_ + bytes <= max_bytes_; };
  if (!fits()) {
    const ThreadPool::Waiting rest;
    ++awaiting_;
    std::vector<Lingering> last;
    last.swap(lingering_);
    lock.unlock();
    last.clear();
    lock.lock();
    const bool is_room = given_back_.wait_for(lock, patience_, fits);
    --awaiting_;
    if (!is_room) throw too_many_results();
  }
  taken_ += bytes;
}

void SharedResults::give_back(std::size_t bytes) {
  {
    const std::lock_guard lock(mutex_);
    taken_ -= bytes;
  }
  given_back_.notify_all();
}

}  // namespace signorini::server
