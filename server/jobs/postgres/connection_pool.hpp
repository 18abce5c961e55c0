#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::postgres {

/// Connections to one database, which threads share by turns.
class ConnectionPool {
 public:
  ConnectionPool(std::string url, std::size_t most) : url_(std::move(url)), most_(most) {}

  /// Does something with a connection that nobody else uses meanwhile. Throws Error: at once if the database
  /// could not be reached a moment ago, and if others use all of them for too long.
  template <class Step>
  auto with(const Step& step) {
    Borrowed borrowed(*this);
    return step(*borrowed.connection);
  }

  /// The database was reached by another way: the next step tries it.
  void try_again();

 private:
  struct Borrowed {
    explicit Borrowed(ConnectionPool& of_pool) : pool(of_pool), connection(of_pool.take()) {}
    ~Borrowed() { pool.give_back(std::move(connection)); }
    Borrowed(const Borrowed&) = delete;
    Borrowed& operator=(const Borrowed&) = delete;

    ConnectionPool& pool;
    std::unique_ptr<Connection> connection;
  };

  std::unique_ptr<Connection> take();
  std::unique_ptr<Connection> connect();
  void give_back(std::unique_ptr<Connection> connection);

  const std::string url_;
  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable free_;
  std::size_t used_ = 0;
  std::vector<std::unique_ptr<Connection>> idle_;
  std::chrono::steady_clock::time_point refused_until_{};
  std::string refusal_;
};

}  // namespace signorini::server::postgres
