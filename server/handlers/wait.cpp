#include "server/handlers/wait.hpp"

#include <algorithm>
#include <charconv>

#include "server/http/query.hpp"

namespace signorini::server {
namespace {

constexpr double longest_wait = 3600;

std::optional<long> preferred_seconds(const std::string& prefer) {
  const std::string key = "wait=";
  for (std::size_t begin = 0; begin < prefer.size();) {
    const std::size_t end = std::min(prefer.find_first_of(",;", begin), prefer.size());
    begin = std::min(prefer.find_first_not_of(" \t", begin), end);
    if (prefer.compare(begin, key.size(), key) == 0) {
      long seconds = -1;
      std::from_chars(prefer.data() + begin + key.size(), prefer.data() + end, seconds);
      if (seconds >= 0) return seconds;
    }
    begin = end + 1;
  }
  return std::nullopt;
}

std::optional<Wait> wait_time_of(const Request& request) {
  using Seconds = std::chrono::duration<double>;
  if (const auto seconds = number_parameter(request.query, "wait", 0, longest_wait)) {
    return Wait{Seconds(*seconds), std::nullopt};
  }
  const auto seconds = preferred_seconds(request.header("Prefer").value_or(""));
  if (!seconds) return std::nullopt;
  const long kept = std::min(*seconds, static_cast<long>(longest_wait));
  return Wait{Seconds(kept), "wait=" + std::to_string(kept)};
}

}  // namespace

std::optional<Wait> wait_of(const Request& request) {
  std::optional<Wait> wait = wait_time_of(request);
  const std::optional<std::string> cancel = parameter(request.query, "cancel");
  if (!cancel) return wait;
  if (*cancel != "disconnect") throw bad_parameter("cancel", "`cancel` can only be `disconnect`.");
  if (!wait) {
    throw bad_parameter("cancel", "`cancel=disconnect` is for a client that waits: add `wait=SECONDS`.");
  }
  wait->or_cancel = true;
  return wait;
}

}  // namespace signorini::server
