#include "server/jobs/postgres/connection_pool.hpp"

namespace signorini::server::postgres {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto patience = longest_statement + 2s;  // with a database that does not answer
constexpr auto between_tries = 500ms;              // to reach a database that could not be reached

}  // namespace

std::unique_ptr<Connection> ConnectionPool::take() {
  {
    std::unique_lock lock(mutex_);
    if (!free_.wait_for(lock, patience, [&] { return used_ < most_; }))
      throw Error("all connections to it are in use");
    while (!idle_.empty()) {
      std::unique_ptr<Connection> connection = std::move(idle_.back());
      idle_.pop_back();
      if (connection->is_lost()) continue;
      ++used_;
      return connection;
    }
    if (Clock::now() < refused_until_) throw Error(refusal_);
    ++used_;
  }
  return connect();
}

/// A place is counted as used already.
std::unique_ptr<Connection> ConnectionPool::connect() {
  try {
    return std::make_unique<Connection>(url_, patience);
  } catch (const Error& error) {
    const std::lock_guard lock(mutex_);
    --used_;
    free_.notify_one();
    refused_until_ = Clock::now() + between_tries;
    refusal_ = error.what();
    throw;
  }
}

void ConnectionPool::try_again() {
  const std::lock_guard lock(mutex_);
  refused_until_ = {};
}

void ConnectionPool::give_back(std::unique_ptr<Connection> connection) {
  const std::lock_guard lock(mutex_);
  --used_;
  if (!connection->is_lost()) idle_.push_back(std::move(connection));
  free_.notify_one();
}

}  // namespace signorini::server::postgres
