#include "server/http/query.hpp"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace signorini::server {
namespace {

template <class Number>
std::optional<Number> whole_number(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

template <class Number>
std::optional<Number> in_range(const Query& query, const std::string& name, Number low, Number high,
                               std::string_view kind) {
  const std::optional<std::string> text = parameter(query, name);
  if (!text) return std::nullopt;
  const std::optional<Number> number = whole_number<Number>(*text);
  if (number && *number >= low && *number <= high) return number;
  std::ostringstream allowed;
  allowed << "`" << name << "` must be " << kind << " from " << low << " to " << high << ".";
  throw bad_parameter(name, allowed.str());
}

std::string names(std::initializer_list<std::string_view> allowed) {
  if (allowed.size() == 0) return "This path takes no query parameters.";
  std::string list;
  for (const std::string_view name : allowed) list += (list.empty() ? "`" : ", `") + std::string(name) + "`";
  return "Allowed here: " + list + ".";
}

}  // namespace

std::string percent_decoded(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned octet = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() &&
        std::from_chars(digits, digits + 2, octet, 16).ptr == digits + 2) {
      plain += static_cast<char>(octet);
      i += 2;
    } else {
      plain += text[i] == '+' ? ' ' : text[i];
    }
  }
  return plain;
}

std::string percent_encoded(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF", unreserved = "-._~";
  std::string encoded;
  for (const char c : text) {
    const auto octet = static_cast<unsigned char>(c);
    const bool is_plain = (octet >= '0' && octet <= '9') || (octet >= 'A' && octet <= 'Z') ||
                          (octet >= 'a' && octet <= 'z') || unreserved.find(c) != std::string_view::npos;
    if (is_plain)
      encoded += c;
    else
      encoded.append(1, '%').append(1, digits[octet >> 4]).append(1, digits[octet & 15]);
  }
  return encoded;
}

Query read_query(std::string_view text) {
  Query query;
  while (!text.empty()) {
    const std::string_view pair = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(pair.size() + 1, text.size()));
    const std::size_t end = std::min(pair.find('='), pair.size());
    if (pair.empty()) continue;
    query.emplace(percent_decoded(pair.substr(0, end)),
                  percent_decoded(pair.substr(std::min(end + 1, pair.size()))));
  }
  return query;
}

void allow_only(const Query& query, std::initializer_list<std::string_view> allowed) {
  for (const auto& [name, value] : query) {
    if (std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
      throw bad_parameter(name, "There is no query parameter `" + name + "`. " + names(allowed));
    }
    if (query.count(name) > 1) throw bad_parameter(name, "`" + name + "` stands more than once.");
    if (value.empty())
      throw bad_parameter(name, "`" + name + "` has no value: give it one, or leave it out.");
  }
}

std::optional<std::string> parameter(const Query& query, const std::string& name) {
  const auto found = query.find(name);
  if (found == query.end()) return std::nullopt;
  return found->second;
}

std::optional<double> number_parameter(const Query& query, const std::string& name, double low, double high) {
  return in_range<double>(query, name, low, high, "a number");
}

std::optional<long> integer_parameter(const Query& query, const std::string& name, long low, long high) {
  return in_range<long>(query, name, low, high, "an integer");
}

HttpError bad_parameter(const std::string& name, const std::string& detail) {
  return {400, {"bad-parameter", "Bad query parameter", detail, {{"parameter", name, detail}}}};
}

}  // namespace signorini::server
