#pragma once

#include <cstdint>
#include <limits>

#include "server/access/access.hpp"
#include "server/handlers/shared_results.hpp"
#include "server/http/event_streams.hpp"
#include "server/http/semaphore.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/jobs/scheduler.hpp"
#include "server/jobs/store.hpp"
#include "server/metrics/metrics.hpp"
#include "server/unique_id.hpp"

namespace signorini::server {

/// What one request may ask for.
struct Limits {
  std::size_t max_body_bytes = 16 << 20;
  std::int64_t max_unknowns = 20'000'000;
  double max_memory = std::numeric_limits<double>::infinity();  ///< bytes that a solve may take
  std::size_t max_result_bytes = 256 << 20;  ///< of results from which replies are written at the same time
  std::size_t max_waits = 4096;              ///< clients that may wait for their solves at the same time
  Factorization factorization = Factorization::multifrontal;  ///< by which memory is predicted
  int threads = 1;                                            ///< of a solve, by which too
};

/// What the handlers work on.
struct Service {
  JobStore& store;
  Scheduler& scheduler;
  EventStreams& events;
  Access& access;
  Limits limits;
  const KeptOperators& operators;
  Metrics& metrics;
  UniqueIds ids = {};
  Semaphore waits{limits.max_waits};  ///< of clients that wait
  SharedResults results{store, limits.max_result_bytes};
};

}  // namespace signorini::server
