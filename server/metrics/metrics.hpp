#pragma once

#include <chrono>
#include <string>
#include <vector>

#include <prometheus/registry.h>

#include "server/http/request.hpp"
#include "server/http/response.hpp"
#include "server/jobs/job.hpp"

namespace signorini::server {

/// What has happened since the start, for Prometheus. Safe to be told by several threads.
class Metrics {
 public:
  Metrics();

  void replied(const Request& request, const Response& response, std::chrono::duration<double> time);
  void ended(const Job& job, const Ending& ending);

  std::vector<prometheus::MetricFamily> collect() const { return registry_.Collect(); }

 private:
  prometheus::Registry registry_;
  prometheus::Family<prometheus::Counter>& requests_;
  prometheus::Family<prometheus::Histogram>& request_seconds_;
  prometheus::Family<prometheus::Counter>& runs_;
  prometheus::Histogram& queue_seconds_;
  prometheus::Family<prometheus::Histogram>& solve_seconds_;
  prometheus::Family<prometheus::Histogram>& unknowns_;
};

}  // namespace signorini::server
