#include "server/http/trace.hpp"

#include <algorithm>
#include <random>
#include <string_view>

namespace signorini::server {
namespace {

constexpr std::string_view digits = "0123456789abcdef";

bool is_hexadecimal(std::string_view text) {
  return text.find_first_not_of(digits) == std::string_view::npos;
}

bool is_zero(std::string_view text) {
  return text.find_first_not_of('0') == std::string_view::npos;
}

std::string new_span() {
  thread_local std::mt19937_64 random{std::random_device{}()};
  std::string span(16, '0');
  std::uint64_t bits = 0;
  while (bits == 0) bits = random();
  for (char& digit : span) {
    digit = digits[bits % 16];
    bits /= 16;
  }
  return span;
}

}  // namespace

std::optional<Trace> read_traceparent(const std::string& header) {
  constexpr std::size_t length = 55;  // 00-<32>-<16>-<2>
  if (header.size() < length) return std::nullopt;
  const std::string_view text = header;
  const std::string_view version = text.substr(0, 2), id = text.substr(3, 32), parent = text.substr(36, 16),
                         flags = text.substr(53, 2);
  const bool separated = text[2] == '-' && text[35] == '-' && text[52] == '-';
  // Later versions may go on behind a dash.
  const bool ends = text.size() == length || (version != "00" && text[length] == '-');
  const bool readable =
      is_hexadecimal(version) && is_hexadecimal(id) && is_hexadecimal(parent) && is_hexadecimal(flags);
  if (!separated || !ends || !readable || version == "ff" || is_zero(id) || is_zero(parent))
    return std::nullopt;
  return Trace{std::string(id), new_span(), std::string(flags)};
}

std::string traceparent(const Trace& trace) {
  return "00-" + trace.id + '-' + trace.span + '-' + trace.flags;
}

}  // namespace signorini::server
