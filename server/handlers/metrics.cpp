#include "server/handlers/metrics.hpp"

#include <prometheus/text_serializer.h>

#include "server/http/query.hpp"
#include "server/jobs/fleet.hpp"
#include "server/metrics/families.hpp"

namespace signorini::server {
namespace {

using Families = std::vector<prometheus::MetricFamily>;

/// How many solves there are of each status; none while the store cannot say.
Families solve_families(const JobStore& store) {
  JobCounts counts;
  std::size_t damaged = 0;
  try {
    counts = store.count();
    damaged = store.damaged();
  } catch (const StoreUnavailable&) {
    return {};
  }
  std::vector<Sample> samples;
  for (const JobStatus status : all_statuses)
    samples.push_back({static_cast<double>(counts[status]), "status", name(status)});
  return {gauge("signorini_solves", "Solves that are kept, by status; those that are queued are the queue.",
                samples),
          gauge("signorini_damaged_solves", "Failed solves of which what is stored is damaged.",
                {{static_cast<double>(damaged)}})};
}

Families fleet_families(Fleet& fleet) {
  return {counter("signorini_stale_writes_total",
                  "Writes that were refused because the claim of the solve was lost to another service.",
                  {{static_cast<double>(fleet.stale_writes())}})};
}

Families operator_families(const OperatorFigures& figures) {
  const auto number = [](auto value) { return std::vector<Sample>{{static_cast<double>(value)}}; };
  return {counter("signorini_operator_cache_hits_total", "Factors of earlier solves that were used again.",
                  number(figures.hits)),
          counter("signorini_operator_cache_misses_total", "Factors that were not there.",
                  number(figures.misses)),
          counter("signorini_operator_cache_evictions_total", "Factors that were dropped to make room.",
                  number(figures.evictions)),
          gauge("signorini_operator_cache_operators", "Factors that are kept.", number(figures.operators)),
          gauge("signorini_operator_cache_bytes", "Memory that they take.", number(figures.bytes))};
}

Families client_families(const Service& service) {
  const auto acquired = [](const Semaphore& semaphore) {
    return std::vector<Sample>{{static_cast<double>(semaphore.acquired())}};
  };
  return {gauge("signorini_waiting_clients", "Clients that wait for their solves.", acquired(service.waits)),
          gauge("signorini_subscribers", "Streams of events that are open.",
                acquired(service.events.open_streams()))};
}

void append(Families& to, Families from) {
  to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

Response get_metrics(Service& service, const Request& request) {
  allow_only(request.query, {});
  const bool ready = service.scheduler.accepting() && !service.store.trouble();
  Families families{
      gauge("signorini_build_info", "Which version runs.", {{1, "version", SIGNORINI_VERSION}}),
      gauge("signorini_ready", "1 if new solves are taken, as /readyz says.", {{ready ? 1. : 0.}})};
  append(families, solve_families(service.store));
  if (Fleet* const fleet = service.store.fleet()) append(families, fleet_families(*fleet));
  append(families, operator_families(service.operators.figures()));
  append(families, service.metrics.collect());
  append(families, client_families(service));
  append(families, process_families());
  Response response = Response::empty(200);
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = prometheus::TextSerializer().Serialize(families);
  return response;
}

}  // namespace signorini::server
