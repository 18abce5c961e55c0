#include "server/jobs/heart.hpp"

#include <algorithm>

#include <spdlog/spdlog.h>

#include "server/log.hpp"

namespace signorini::server {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t most_iterations = 10'000;  // told at once

std::chrono::milliseconds between_beats(const Fleet& fleet) {
  return std::min<std::chrono::milliseconds>(1s, fleet.lease() / 4);
}

void lose(const Held& held, const char* why) {
  if (held.live->is_lost()) return;
  held.live->lose();
  const LogField job("job", held.job);
  spdlog::warn("the claim is lost: {}; the solve ends here", why);
}

}  // namespace

Heart::Heart(Fleet& fleet, std::function<std::vector<Held>()> held)
    : fleet_(fleet), held_(std::move(held)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

Heart::~Heart() {
  thread_.request_stop();
  thread_.join();
}

void Heart::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    beat();
    std::unique_lock lock(mutex_);
    wake_.wait_for(lock, stop, between_beats(fleet_), [] { return false; });
  }
}

void Heart::beat() {
  const std::vector<Held> held = held_();
  const auto now = Clock::now();
  const std::vector<Heartbeat> beats = heartbeats(held);
  try {
    const std::vector<Standing> standings = fleet_.renew(beats);
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (standings[i] == Standing::lost) {
        lose(held[i], "it was not renewed in time");
        continue;
      }
      Pulse& pulse = pulses_.at(held[i].job);
      pulse.renewed = now;
      pulse.told += beats[i].advance.iterations.size();
      if (standings[i] == Standing::to_be_cancelled) held[i].live->cancel();
    }
    fleet_.rescue();
  } catch (const StoreUnavailable&) {
    lose_what_is_over(held);
  } catch (const std::exception& error) {
    spdlog::error("claims could not be renewed: {}", error.what());
    lose_what_is_over(held);
  }
}

std::vector<Heartbeat> Heart::heartbeats(const std::vector<Held>& held) {
  std::map<std::string, Pulse> pulses;
  std::vector<Heartbeat> beats;
  for (const Held& each : held) {
    const auto known = pulses_.find(each.job);
    // Whoever was not there the last time was claimed since then.
    const bool is_new = known == pulses_.end() || known->second.attempt != each.attempt;
    const Pulse pulse = is_new ? Pulse{each.attempt, Clock::now() - between_beats(fleet_)} : known->second;
    pulses[each.job] = pulse;
    beats.push_back(
        {each.job, each.attempt, pulse.told, each.live->advance_after(pulse.told, most_iterations)});
  }
  pulses_ = std::move(pulses);
  return beats;
}

void Heart::lose_what_is_over(const std::vector<Held>& held) {
  for (const Held& each : held)
    if (Clock::now() - pulses_.at(each.job).renewed > fleet_.lease())
      lose(each, "the database is out of reach");
}

}  // namespace signorini::server
