#include "server/handlers/wait.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "server/http/field_value.hpp"
#include "server/http/query.hpp"

namespace signorini::server {
namespace {

constexpr double longest_wait = 3600;

/// A preference without a number of seconds is none.
std::optional<long> preferred_seconds(const Request& request) {
  const std::string wait = preference(request.header("Prefer").value_or(""), "wait").value_or("");
  const bool is_number = !wait.empty() && wait.find_first_not_of("0123456789") == std::string::npos;
  if (!is_number) return std::nullopt;
  long seconds = std::numeric_limits<long>::max();  // stays so for a larger number
  std::from_chars(wait.data(), wait.data() + wait.size(), seconds);
  return seconds;
}

std::optional<Wait> wait_time_of(const Request& request) {
  using Seconds = std::chrono::duration<double>;
  if (const auto seconds = number_parameter(request.query, "wait", 0, longest_wait)) {
    return Wait{Seconds(*seconds), std::nullopt};
  }
  const auto seconds = preferred_seconds(request);
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
