#pragma once

#include <chrono>
#include <string>

#include "becomes.hpp"
#include "server/jobs/fleet.hpp"
#include "server/jobs/postgres/connection.hpp"

namespace signorini::server {

/// How long a claim is held in the stores of tests that lose some.
constexpr std::chrono::milliseconds lease_of_stores{300};

/// The runner of a job is silent for longer than its claim is held. Whether the claim is rescued: for a lease
/// after the start of the database none is.
inline bool lose(const std::string& database, Fleet& fleet, const std::string& job) {
  postgres::Connection connection(database, std::chrono::seconds(5));
  connection.script("UPDATE leases SET until = 0 WHERE job = '" + job + "'");
  return becomes([&] {
    fleet.rescue();
    return connection.run("SELECT FROM leases WHERE job = $1", postgres::Values(job)).empty();
  });
}

}  // namespace signorini::server
