#include "server/jobs/lookout.hpp"

#include <algorithm>
#include <set>

#include <spdlog/spdlog.h>

namespace signorini::server {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto between_looks = 500ms;  // without hints
constexpr auto between_hints = 50ms;   // of one process

}  // namespace

Lookout::Lookout(Fleet& fleet, LookoutEars ears)
    : fleet_(fleet),
      ears_(std::move(ears)),
      telling_([this](const std::stop_token& stop) { tell(stop); }),
      listening_([this](const std::stop_token& stop) { listen(stop); }) {}

/// What is told reaches the one that listens here, too, which sleeps until then.
Lookout::~Lookout() {
  listening_.request_stop();
  hint();
}

void Lookout::hint() {
  {
    const std::lock_guard lock(mutex_);
    has_news_ = true;
  }
  wake_.notify_all();
}

void Lookout::listen(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      if (fleet_.wait_for_hint(between_looks)) ears_.queued();
      const auto begin = Clock::now();
      look();
      // Half of the time at most, however much others hint and however many wait here.
      pause(stop, std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin));
    } catch (const StoreUnavailable&) {
      pause(stop, between_looks);
    } catch (const std::exception& error) {
      spdlog::error("other processes cannot be seen: {}", error.what());
      pause(stop, between_looks);
    }
  }
}

void Lookout::look() {
  const std::vector<std::string> ids = ears_.sought();
  std::erase_if(mirrors_, [&](const auto& each) { return std::ranges::find(ids, each.first) == ids.end(); });
  if (ids.empty()) return;
  std::vector<Sought> sought;
  for (const std::string& id : ids) {
    const auto mirror = mirrors_.find(id);
    sought.push_back(mirror == mirrors_.end() ? Sought{id}
                                              : Sought{id, mirror->second.attempt, mirror->second.known});
  }
  std::set<std::string> gone(ids.begin(), ids.end());
  for (Found& found : fleet_.look(sought)) {
    gone.erase(found.job);
    follow(found);
    if (has_ended(found.status)) ears_.ended(found.job);
  }
  for (const std::string& id : gone) ears_.ended(id);
}

void Lookout::follow(Found& found) {
  if (!found.started) return;
  Mirror& mirror = mirrors_[found.job];
  const bool is_new = !mirror.live || mirror.attempt != found.attempt;
  if (is_new) mirror = {found.attempt, 0, std::make_shared<LiveSolve>(*found.started)};
  if (has_ended(found.status)) found.advance.progress = mirror.live->progress();
  mirror.live->follow(found.advance);
  mirror.known += found.advance.iterations.size();
  // Not before: a solve of this process that has just ended is told of as over by others, with what is there
  // then.
  if (is_new) ears_.begun(found.job, mirror.live);
}

void Lookout::tell(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, stop, [this] { return has_news_; });
      if (stop.stop_requested()) return;
      has_news_ = false;
    }
    try {
      fleet_.hint();
    } catch (const std::exception&) {
      // Others look by themselves.
    }
    pause(stop, between_hints);
  }
}

void Lookout::pause(const std::stop_token& stop, std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  wake_.wait_for(lock, stop, time, [] { return false; });
}

}  // namespace signorini::server
