#include "server/handlers/routes.hpp"

#include <algorithm>
#include <iterator>

#include "server/handlers/batches.hpp"
#include "server/handlers/document_response.hpp"
#include "server/handlers/downloads.hpp"
#include "server/handlers/events.hpp"
#include "server/handlers/fields.hpp"
#include "server/handlers/health.hpp"
#include "server/handlers/intake.hpp"
#include "server/handlers/lists.hpp"
#include "server/handlers/metrics.hpp"
#include "server/handlers/openapi.hpp"
#include "server/handlers/pages.hpp"
#include "server/handlers/problems.hpp"
#include "server/handlers/solves.hpp"

namespace signorini::server {

namespace {

using Handle = Response (*)(Service& service, const Request& request);

Handler bound(Service& service, Handle handle) {
  return [&service, handle](const Request& request) { return handle(service, request); };
}

/// Probes send whatever Accept they like.
std::vector<Route> routes_of_watchers(Service& service) {
  return {{"GET", "/healthz", {}, bound(service, healthz), Audience::probes},
          {"GET", "/readyz", {}, bound(service, readyz), Audience::probes},
          {"GET", "/metrics", {}, bound(service, get_metrics), Audience::monitors}};
}

Router router_of(std::vector<Route> table, Service& service) {
  return {std::move(table), service.access,
          [&metrics = service.metrics](const Request& request, const Response& response,
                                       std::chrono::duration<double> time) {
            metrics.replied(request, response, time);
          }};
}

}  // namespace

Router routes_of_worker(Service& service) {
  return router_of(routes_of_watchers(service), service);
}

Router routes(Service& service) {
  const auto with = [&service](Handle handle) { return bound(service, handle); };
  // What is made of a whole result may be read, written and compressed for seconds.
  const auto has_result = [](const Query& query) {
    return picks_summary_alone(query) ? Length::brief : Length::result;
  };
  const auto long_reply = [&](const std::string& pattern, std::vector<std::string> media_types,
                              Response (*handle)(Service&, const Request&)) -> Route {
    return {"GET", pattern, std::move(media_types), with(handle), Audience::clients, has_result};
  };
  const auto with_page = [](Route route, Handler page) {
    route.page = std::move(page);
    return route;
  };
  std::vector<Route> table{
      {"POST", "/v1/solves", document_types, with(post_solve), Audience::clients, has_result,
       require_readable},
      with_page({"GET", "/v1/solves", document_types, with(list_solves), Audience::clients, length_of_list},
                page_of("Solves · Signorini", "solves", "solves")),
      {"DELETE", "/v1/solves", document_types, with(delete_tagged)},
      with_page({"GET", "/v1/solves/{id}", document_types, with(get_solve)},
                page_of("Solve · Signorini", "solve", "solve")),
      {"DELETE", "/v1/solves/{id}", document_types, with(delete_solve)},
      long_reply("/v1/solves/{id}/result", document_types, get_result),
      long_reply("/v1/solves/{id}/result.vtu", {vtu_media_type}, get_result_vtu),
      long_reply("/v1/solves/{id}/picture.svg", {svg_media_type}, get_picture),
      long_reply("/v1/solves/{id}/history.csv", {"text/csv"}, get_history_csv),
      long_reply("/v1/solves/{id}/contact.csv", {"text/csv"}, get_contact_csv),
      long_reply("/v1/solves/{id}/quantities.csv", {"text/csv"}, get_quantities_csv),
      long_reply("/v1/solves/{id}/study.csv", {"text/csv"}, get_study_csv),
      long_reply("/v1/solves/{id}/history", document_types, get_history),
      // Of a solve that has ended they are made of its result.
      {"GET",
       "/v1/solves/{id}/events",
       {event_stream_media_type},
       with(get_events),
       Audience::clients,
       [](const Query&) { return Length::result; }},
      {"POST", "/v1/studies", document_types, with(post_study), Audience::clients, has_result,
       require_readable},
      {"POST", "/v1/batches", document_types, with(post_batch), Audience::clients, nullptr, require_readable,
       true},
      {"GET", "/v1/batches/{id}", document_types, with(get_batch)},
      {"DELETE", "/v1/batches/{id}", document_types, with(delete_batch)},
      {"GET",
       "/v1/batches/{id}/results",
       {ndjson_media_type, cbor_sequence_media_type},
       with(get_batch_results)},
      {"POST", "/v1/validate", document_types, with(validate_problem), Audience::clients, nullptr,
       require_readable},
      {"GET", "/v1/examples", document_types, with(list_examples)},
      with_page({"GET", "/v1/examples/{name}", document_types, with(get_example)},
                page_of("Example · Signorini", "start", "problem")),
      // An <img> of a page shows no token.
      {"GET",
       "/v1/examples/{name}/picture.svg",
       {svg_media_type},
       with(get_example_picture),
       Audience::everybody},
      {"GET", "/openapi.json", {"application/json"}, with(get_openapi), Audience::everybody},
      {"GET", "/", {"text/html"}, page_of("Signorini", "start", "start"), Audience::everybody},
      {"GET",
       "/docs",
       {"text/html"},
       page_of("The interface · Signorini", "docs", "docs"),
       Audience::everybody},
      // Browsers ask for a style or script by what it is for, and may name neither type.
      {"GET", "/pages/{file}", {}, with(get_page_file), Audience::everybody},
  };
  std::ranges::move(routes_of_watchers(service), std::back_inserter(table));
  return router_of(std::move(table), service);
}

}  // namespace signorini::server
