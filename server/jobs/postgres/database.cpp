#include "server/jobs/postgres/database.hpp"

#include <algorithm>
#include <array>

#include <spdlog/spdlog.h>

#include "server/jobs/postgres/migrations.hpp"
#include "server/jobs/postgres/url.hpp"

namespace signorini::server::postgres {
namespace {

/// Four replicas leave some of the 100 that PostgreSQL allows by default to others.
constexpr std::size_t most_connections = 16;

/// Whether it may pass: the connection, resources, an operator, a conflict, the system, or a server that only
/// reads.
bool may_pass(const std::string& state) {
  constexpr std::array classes{"08", "53", "57", "40", "58", "25", "55"};
  return state.empty() || std::ranges::find(classes, state.substr(0, 2)) != classes.end();
}

/// Throws CannotOpenStore if there are texts that the database cannot hold.
void require_utf8(Connection& connection) {
  const std::string encoding = connection.run("SHOW server_encoding").text(0, 0);
  if (encoding == "UTF8") return;
  throw CannotOpenStore("the database (--database) holds texts in " + encoding +
                        " and not in UTF-8; make one with CREATE DATABASE … ENCODING 'UTF8'");
}

/// Whether it is a matter of one statement: a conflict, a lock, or that it took too long.
bool is_of_one_statement(const std::string& state) {
  return state.starts_with("40") || state.starts_with("55") || state == "57014";
}

/// For clients, whom neither the host nor the role of the database concerns.
std::string in_words(const Error& error) {
  if (error.state.empty()) return "the database cannot be reached";
  return "the database does not do what it should (SQLSTATE " + error.state + ")";
}

}  // namespace

Database::Database(const std::string& url) : url_(url), pool_(url, most_connections) {
  // An index of many rows takes its time.
  constexpr std::chrono::hours patience_with_migrations{1};
  try {
    Connection connection(url, patience_with_migrations);
    require_utf8(connection);
    migrate(connection);
  } catch (const Error& error) {
    throw CannotOpenStore("cannot use the database " + without_password(url) +
                          " (--database): " + error.what());
  }
}

/// Inside a handler of the error.
void Database::rethrow_as_unavailable(const Error& error) const {
  if (!may_pass(error.state)) throw;
  if (is_of_one_statement(error.state)) throw StoreUnavailable(in_words(error));
  const std::lock_guard lock(trouble_mutex_);
  if (trouble_.empty()) spdlog::error("the database cannot be used: {}", error.what());
  trouble_ = in_words(error);
  throw StoreUnavailable(trouble_);
}

std::string Database::known_trouble() const {
  const std::lock_guard lock(trouble_mutex_);
  return trouble_;
}

std::optional<Rows> Database::glance(const std::string& sql) const {
  constexpr std::chrono::seconds patience{2};
  const std::unique_lock glancing(glancing_, std::try_to_lock);
  if (!glancing) return std::nullopt;
  return with_own(glance_, patience, "", [&](Connection& connection) { return connection.run(sql); });
}

std::optional<std::string> Database::trouble() const {
  const std::string known = known_trouble();
  try {
    // A write, if the last step failed.
    const auto answer =
        glance(known.empty() ? "SELECT 1" : "UPDATE tallies SET queued = queued WHERE shard = 0");
    if (!answer) return known.empty() ? std::nullopt : std::optional(known);
  } catch (const StoreUnavailable& unavailable) {
    return unavailable.what();
  }
  pool_.try_again();
  const std::lock_guard lock(trouble_mutex_);
  if (!trouble_.empty()) spdlog::info("the database can be used again");
  trouble_.clear();
  return std::nullopt;
}

}  // namespace signorini::server::postgres
