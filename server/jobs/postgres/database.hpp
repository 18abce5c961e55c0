#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "server/jobs/postgres/connection_pool.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server::postgres {

/// The database of a store, with the tables of this version.
class Database {
 public:
  /// Throws CannotOpenStore.
  explicit Database(const std::string& url);

  /// Runs a step on a connection. Throws StoreUnavailable if the database is at fault, for now.
  template <class Step>
  auto with(const Step& step) const {
    try {
      return pool_.with(step);
    } catch (const Error& error) {
      rethrow_as_unavailable(error);
    }
  }

  /// The same on a connection of its own, which is made by this script if it is missing.
  template <class Step>
  auto with_own(std::optional<Connection>& own, std::chrono::seconds patience, const std::string& beginning,
                const Step& step) const {
    try {
      if (own && own->is_lost()) own.reset();
      if (!own) {
        Connection fresh(url_, patience);
        fresh.script(beginning);
        own.emplace(std::move(fresh));
      }
      return step(*own);
    } catch (const Error& error) {
      rethrow_as_unavailable(error);
    }
  }

  /// Runs one statement.
  Rows run(const std::string& sql, const Values& values = Values()) const {
    return with([&](Connection& connection) { return connection.run(sql, values); });
  }

  /// Why the database cannot be written for now. Tries it.
  std::optional<std::string> trouble() const;

  /// Runs one statement of those who watch over the service, on a connection of theirs. They do not wait for
  /// long; and while one of them asks, the others get nothing, so that a database that does not answer holds
  /// up one thread.
  std::optional<Rows> glance(const std::string& sql) const;

 private:
  [[noreturn]] void rethrow_as_unavailable(const Error& error) const;
  std::string known_trouble() const;

  const std::string url_;
  mutable ConnectionPool pool_;
  mutable std::mutex trouble_mutex_;
  mutable std::string trouble_;  ///< that was logged, and may have passed
  mutable std::mutex glancing_;
  mutable std::optional<Connection> glance_;  ///< for glance()
};

}  // namespace signorini::server::postgres
