#include "server/access/bearer_tokens.hpp"

#include <strings.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string_view>
#include <vector>

#include <openssl/sha.h>
#include <CLI/CLI.hpp>

#include "server/access/request_rate.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

constexpr std::size_t shortest_token = 16;
constexpr std::size_t longest_name = 64;

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

struct Entry {
  std::string token;
  Identity identity;
};

/// The same whatever stands around the token in the file, and nothing by which it could be found.
std::string name_of_its_own(const std::string& token) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(), digest.data());
  std::ostringstream name;
  name << "token-" << std::hex;
  for (int i = 0; i < 4; ++i) name << digest[i] / 16 << digest[i] % 16;
  return name.str();
}

/// What is wrong with a line of the file.
class BadLine : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void require_name(const std::string& name) {
  const bool good = name.size() <= longest_name && std::ranges::all_of(name, [](unsigned char c) {
                      return std::isalnum(c) || c == '-' || c == '_' || c == '.';
                    });
  if (!good) throw BadLine("has a bad name: one has 1 to 64 letters, digits, `-`, `_` and `.`");
}

std::uint8_t scopes_of(const std::string& words) {
  constexpr auto bit = [](Scope scope) { return static_cast<std::uint8_t>(scope); };
  static const std::map<std::string, std::uint8_t, std::less<>> known{
      {"read", bit(Scope::read) | bit(Scope::metrics)},
      {"solve", bit(Scope::solve)},
      {"admin", bit(Scope::admin)},
      {"metrics", bit(Scope::metrics)}};
  std::uint8_t scopes = 0;
  std::istringstream list(words);
  for (std::string word; std::getline(list, word, ',');) {
    const auto scope = known.find(word);
    if (scope == known.end())
      throw BadLine("has an unknown scope; known are `read`, `solve`, `admin` and `metrics`");
    scopes |= scope->second;
  }
  return scopes;
}

/// Nothing if the text is no number within bounds that a limit may have.
std::optional<double> number_of(const std::string& text, double most) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && number > 0 && number <= most ? std::optional(number) : std::nullopt;
}

/// As the flags take them: 1048576, 1024kb, 1mb.
std::string in_bytes(std::string text) {
  try {
    CLI::AsSizeValue(false)(text);
  } catch (const CLI::Error&) {
    return {};
  }
  return text;
}

void set_limit(Identity& identity, const std::string& word) {
  const std::size_t sign = std::min(word.find('='), word.size());
  const std::string limit = word.substr(0, sign);
  const std::string value = word.substr(std::min(sign + 1, word.size()));
  const auto number = limit == "memory" ? number_of(in_bytes(value), 1e18) : number_of(value, 1e6);
  if (number && limit == "memory") {
    identity.share.memory = *number;
  } else if (number && limit == "queue") {
    identity.share.queue = static_cast<std::size_t>(*number);
  } else if (number && limit == "weight" && *number >= 0.001) {
    identity.share.weight = *number;
  } else if (number && limit == "rate") {
    identity.rate = *number;
  } else {
    throw BadLine("has a bad limit; limits are queue=N, memory=BYTES, rate=N and weight=N");
  }
}

Entry entry_of(const std::vector<std::string>& words) {
  const bool alone = words.size() == 1;
  if (words.size() == 2) throw BadLine("is no `name scopes token`");
  Entry entry{words[alone ? 0 : 2], {}};
  if (!is_token(entry.token))
    throw BadLine(
        "has no token: one has at least 16 visible ASCII characters; `openssl rand -hex 32` makes one");
  if (!alone) require_name(words[0]);
  entry.identity.name = alone ? name_of_its_own(entry.token) : words[0];
  entry.identity.scopes = scopes_of(alone ? "read,solve" : words[1]);
  for (std::size_t i = 3; i < words.size(); ++i) set_limit(entry.identity, words[i]);
  return entry;
}

void require_consistent(const std::vector<Entry>& earlier, const Entry& entry) {
  for (const Entry& each : earlier) {
    if (each.token == entry.token) throw BadLine("has a token that was there before");
    const Identity &a = each.identity, &b = entry.identity;
    if (a.name == b.name && (a.share.queue != b.share.queue || a.share.memory != b.share.memory ||
                             a.share.weight != b.share.weight || a.rate != b.rate))
      throw BadLine("gives `" + b.name + "` other limits than a line before");
  }
}

}  // namespace

struct BearerTokens::Table {
  std::vector<Entry> entries;
  std::map<std::string, std::unique_ptr<RequestRate>> rates;  ///< by name, of those that have one
};

BearerTokens::BearerTokens(std::string file) : file_(std::move(file)), table_(read(file_)) {}

void BearerTokens::reload() {
  if (file_.empty()) return;
  std::shared_ptr<const Table> fresh = read(file_);
  const std::lock_guard lock(mutex_);
  table_ = std::move(fresh);
}

std::shared_ptr<const BearerTokens::Table> BearerTokens::read(const std::string& file) {
  std::ifstream lines(file);
  if (!lines) throw BadTokenFile("the token file " + file + " cannot be read (--token-file)");
  const auto table = std::make_shared<Table>();
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream text(line);
    const std::vector<std::string> words(std::istream_iterator<std::string>(text), {});
    if (words.empty()) continue;
    try {
      const Entry entry = entry_of(words);
      require_consistent(table->entries, entry);
      if (entry.identity.rate > 0)
        table->rates[entry.identity.name] = std::make_unique<RequestRate>(entry.identity.rate);
      table->entries.push_back(entry);
    } catch (const BadLine& bad) {
      throw BadTokenFile("line " + std::to_string(number) + " of the token file " + file + " " + bad.what());
    }
  }
  if (table->entries.empty()) throw BadTokenFile("the token file " + file + " holds no token (--token-file)");
  std::vector<std::string> tokens;
  for (const Entry& entry : table->entries) tokens.push_back(entry.token);
  hide_in_log(tokens);
  return table;
}

std::shared_ptr<const BearerTokens::Table> BearerTokens::table() const {
  const std::lock_guard lock(mutex_);
  return table_;
}

std::optional<Identity> BearerTokens::identify(const std::optional<std::string>& authorization) const {
  const auto known = table();
  if (!known) return Identity();
  constexpr std::string_view scheme = "Bearer ";
  if (!authorization || strncasecmp(authorization->c_str(), scheme.data(), scheme.size()) != 0)
    return std::nullopt;
  std::string_view presented = std::string_view(*authorization).substr(scheme.size());
  presented.remove_prefix(std::min(presented.find_first_not_of(' '), presented.size()));  // RFC 9110, 11.4
  const Identity* found = nullptr;
  for (const Entry& entry : known->entries)
    if (equal(presented, entry.token)) found = &entry.identity;
  return found == nullptr ? std::nullopt : std::optional(*found);
}

std::chrono::duration<double> BearerTokens::count(const Identity& identity) const {
  const auto known = table();
  if (!known) return {};
  const auto rate = known->rates.find(identity.name);
  if (rate == known->rates.end()) return {};
  return rate->second->count(identity.name, RequestRate::Clock::now());
}

}  // namespace signorini::server
