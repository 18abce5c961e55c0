#include "server/http/request.hpp"

#include <algorithm>
#include <cctype>

namespace signorini::server {

bool CaseInsensitive::operator()(std::string_view a, std::string_view b) const {
  return std::lexicographical_compare(
      a.begin(), a.end(), b.begin(), b.end(),
      [](unsigned char x, unsigned char y) { return std::tolower(x) < std::tolower(y); });
}

std::optional<std::string> Request::header(std::string_view name) const {
  std::optional<std::string> joined;
  const auto [first, last] = headers.equal_range(name);
  for (auto it = first; it != last; ++it) joined = joined ? *joined + ", " + it->second : it->second;
  return joined;
}

}  // namespace signorini::server
