#pragma once

#include <string>

#include <sys/types.h>

namespace signorini::server {

/// A PostgreSQL server in a temporary directory, which is reached by a socket there. It runs as the user
/// `postgres` where tests run as root, and ends with whoever started it.
class PostgresServer {
 public:
  PostgresServer();
  ~PostgresServer();

  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// The URL of a new database of this name.
  std::string new_database(const std::string& name);
  void drop_database(const std::string& name);
  std::string url(const std::string& database) const;

  void start();
  /// SIGINT ends its sessions in order, SIGKILL at once.
  void end(int signal);

 private:
  std::string directory_;
  pid_t pid_ = -1;
};

/// One that all tests of a process share; the URL of an empty database of it.
PostgresServer& shared_postgres();
std::string empty_database();

}  // namespace signorini::server
