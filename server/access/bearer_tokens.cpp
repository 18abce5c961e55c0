#include "server/access/bearer_tokens.hpp"

#include <strings.h>

#include <algorithm>
#include <fstream>
#include <string_view>

namespace signorini::server {
namespace {

constexpr std::size_t shortest_token = 16;

bool is_token(const std::string& text) {
  return text.size() >= shortest_token &&
         std::ranges::all_of(text, [](char c) { return c > ' ' && c <= '~'; });
}

/// Looks at every byte that was presented, whatever the first ones are.
bool equal(std::string_view presented, std::string_view token) {
  unsigned difference = presented.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < presented.size(); ++i) {
    difference |=
        static_cast<unsigned char>(presented[i]) ^ static_cast<unsigned char>(token[i % token.size()]);
  }
  return difference == 0;
}

}  // namespace

BearerTokens::BearerTokens(const std::string& file) {
  std::ifstream lines(file);
  if (!lines) throw BadTokenFile("the token file " + file + " cannot be read (--token-file)");
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty()) continue;
    if (!is_token(line)) {
      throw BadTokenFile("line " + std::to_string(number) + " of the token file " + file +
                         " is no token: one has at least 16 visible ASCII characters; `openssl rand -hex 32` "
                         "makes one");
    }
    tokens_.push_back(std::move(line));
  }
  if (tokens_.empty()) throw BadTokenFile("the token file " + file + " holds no token (--token-file)");
}

bool BearerTokens::accept(const std::optional<std::string>& authorization) const {
  if (tokens_.empty()) return true;
  constexpr std::string_view scheme = "Bearer ";
  if (!authorization || strncasecmp(authorization->c_str(), scheme.data(), scheme.size()) != 0) return false;
  const std::string_view presented = std::string_view(*authorization).substr(scheme.size());
  bool accepted = false;
  for (const std::string& token : tokens_) accepted |= equal(presented, token);
  return accepted;
}

}  // namespace signorini::server
