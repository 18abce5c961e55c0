#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

namespace signorini::server {

/// A PostgreSQL server in a temporary directory, which is reached by a socket there. It runs as the user
/// `postgres` where tests run as root, and ends with whoever started it.
class PostgresServer {
 public:
  /// With settings beyond the usual ones, as name=value. The port tells sockets apart, and is the one where
  /// `listen_addresses` are given.
  explicit PostgresServer(std::vector<std::string> settings = {}, int port = 5432);
  ~PostgresServer();

  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// The URL of a new database of this name.
  std::string new_database(const std::string& name);
  void drop_database(const std::string& name);
  std::string url(const std::string& database) const;
  /// The socket of it in the file system.
  std::string socket() const { return directory_ + "/.s.PGSQL." + std::to_string(port_); }
  const std::string& directory() const { return directory_; }

  void start();
  /// SIGINT ends its sessions in order, SIGKILL at once.
  void end(int signal);

 private:
  const std::vector<std::string> settings_;
  const int port_;
  std::string directory_;
  pid_t pid_ = -1;
};

/// One that all tests of a process share; the URL of an empty database of it.
PostgresServer& shared_postgres();
std::string empty_database();

}  // namespace signorini::server
