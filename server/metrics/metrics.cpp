#include "server/metrics/metrics.hpp"

#include <algorithm>

#include <prometheus/counter.h>
#include <prometheus/histogram.h>

namespace signorini::server {
namespace {

using prometheus::Histogram;

/// Seconds, from a small problem to the largest.
const Histogram::BucketBoundaries second_buckets{0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1,
                                                 3,     10,    30,   100,  300, 1000};
const Histogram::BucketBoundaries unknown_buckets{1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8};

prometheus::Family<Histogram>& histograms(prometheus::Registry& registry, const std::string& name,
                                          const std::string& help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

/// A client may invent paths and methods, which would each make a new series.
std::string route_of(const Request& request) {
  return request.route.empty() ? "none" : request.route;
}

std::string method_of(const Request& request) {
  return request.route.empty() ? "none" : request.method;
}

}  // namespace

Metrics::Metrics()
    : requests_(prometheus::BuildCounter()
                    .Name("signorini_http_requests_total")
                    .Help("Replies, by the method, the route (none: no route has this path) and the status.")
                    .Register(registry_)),
      request_seconds_(
          histograms(registry_, "signorini_http_request_seconds",
                     "Seconds until a reply was made, the wait for a solve included, by route.")),
      runs_(prometheus::BuildCounter()
                .Name("signorini_runs_total")
                .Help("Runs of solves that ended, by the status in which they ended.")
                .Register(registry_)),
      queue_seconds_(histograms(registry_, "signorini_queue_seconds",
                                "Seconds from the acceptance of a solve to the beginning of its run.")
                         .Add({}, second_buckets)),
      solve_seconds_(histograms(registry_, "signorini_solve_seconds",
                                "Seconds of solves with a result, by phase; total is the whole solve.")),
      unknowns_(
          histograms(registry_, "signorini_solve_unknowns", "Unknowns of solves with a result, by field.")) {
  // From the start, so that a rate is known from the first run on.
  for (const JobStatus status : all_statuses)
    if (has_ended(status)) runs_.Add({{"status", name(status)}});
}

void Metrics::replied(const Request& request, const Response& response, std::chrono::duration<double> time) {
  requests_
      .Add({{"method", method_of(request)},
            {"route", route_of(request)},
            {"status", std::to_string(response.status)}})
      .Increment();
  request_seconds_.Add({{"route", route_of(request)}}, second_buckets).Observe(time.count());
}

void Metrics::ended(const Job& job, const Ending& ending) {
  runs_.Add({{"status", name(ending.status)}}).Increment();
  // In a fleet the two are by clocks of two machines.
  if (job.started)
    queue_seconds_.Observe(std::max(0., std::chrono::duration<double>(*job.started - job.created).count()));
  if (!ending.solution) return;
  const Timings& timings = ending.solution->summary.timings;
  for (const auto& [phase, seconds] : {std::pair{"mesh", timings.mesh},
                                       {"assemble", timings.assemble},
                                       {"factorize", timings.factorize},
                                       {"iterate", timings.iterate},
                                       {"certify", timings.certify},
                                       {"total", timings.total}})
    solve_seconds_.Add({{"phase", phase}}, second_buckets).Observe(seconds);
  const Unknowns& unknowns = ending.solution->summary.unknowns;
  for (const auto& [field, count] : {std::pair{"stress", unknowns.stress},
                                     {"displacement", unknowns.displacement},
                                     {"contact", unknowns.contact},
                                     {"rotation", unknowns.rotation}})
    unknowns_.Add({{"field", field}}, unknown_buckets).Observe(static_cast<double>(count));
}

}  // namespace signorini::server
