#include "server/http/router.hpp"

#include <algorithm>

#include "server/http/conditions.hpp"
#include "server/http/error.hpp"
#include "server/http/media_type.hpp"
#include "server/http/sender_fields.hpp"

namespace signorini::server {
namespace {

using PathParameters = std::map<std::string, std::string>;

/// Takes the text up to the next slash off the path.
std::string_view next_segment(std::string_view& path) {
  const std::size_t slash = std::min(path.find('/'), path.size());
  const std::string_view segment = path.substr(0, slash);
  path.remove_prefix(std::min(slash + 1, path.size()));
  return segment;
}

std::size_t segments(std::string_view path) {
  std::size_t count = 1;
  for (const char c : path) count += c == '/';
  return count;
}

std::optional<PathParameters> match(std::string_view pattern, std::string_view path) {
  if (segments(pattern) != segments(path)) return std::nullopt;
  PathParameters parameters;
  for (std::size_t left = segments(pattern); left > 0; --left) {
    const std::string_view expected = next_segment(pattern);
    const std::string_view actual = next_segment(path);
    if (expected.starts_with('{')) {
      parameters.emplace(expected.substr(1, expected.size() - 2), actual);
    } else if (expected != actual) {
      return std::nullopt;
    }
  }
  return parameters;
}

HttpError not_acceptable(const Route& route) {
  std::string list;
  for (const std::string& media_type : route.media_types) list += (list.empty() ? "" : " or ") + media_type;
  return {406,
          {"not-acceptable", "Not acceptable",
           "This path answers with " + list + ", which the Accept header excludes."}};
}

/// The media type of the reply. Throws HttpError 406.
std::string negotiate(const Request& request, const Route& route) {
  if (route.media_types.empty()) return {};
  if (auto media_type = preferred(request.header("Accept"), route.media_types)) return *media_type;
  throw not_acceptable(route);
}

const std::string html = "text/html";

/// Whether a browser asks, which is to see the page of the route.
bool wants_page(const Request& request, const Route& route) {
  if (!route.page || request.method == "OPTIONS") return false;
  std::vector<std::string> types = route.media_types;
  types.push_back(html);
  return preferred(request.header("Accept"), types) == html;
}

/// The methods of routes, and the one that asks for them.
std::pair<std::string, std::string> allow(const std::string& methods) {
  return {"Allow", methods + ", OPTIONS"};
}

HttpError method_not_allowed(const std::string& method, const std::string& methods) {
  return {405,
          {"method-not-allowed", "Method not allowed",
           method + " is not for this path; allowed: " + allow(methods).second + "."},
          {allow(methods)}};
}

/// To OPTIONS (RFC 9110, 9.3.7).
Response options(const std::string& methods) {
  Response response = Response::empty(204);
  response.headers.push_back(allow(methods));
  return response;
}

}  // namespace

bool Router::is_for_probes(std::string_view path) const {
  return std::ranges::any_of(routes_, [&](const Route& route) {
    return route.audience == Audience::probes && route.pattern == path;
  });
}

Length Router::length(std::string_view method, std::string_view path, const Query& query) const {
  if (method == "HEAD") method = "GET";
  const auto route = std::ranges::find_if(routes_, [&](const Route& each) {
    return each.length != nullptr && each.method == method && match(each.pattern, path);
  });
  return route == routes_.end() ? Length::brief : route->length(query);
}

bool Router::is_long_to_read(std::string_view method, std::string_view path) const {
  return std::ranges::any_of(routes_, [&](const Route& route) {
    return route.is_long_to_read && route.method == method && match(route.pattern, path);
  });
}

Router::Found Router::find(Request& request) const {
  const std::string method = request.method == "HEAD" ? "GET" : request.method;
  Found found;
  for (const Route& route : routes_) {
    std::optional<PathParameters> parameters = match(route.pattern, request.path);
    if (!parameters) continue;
    request.route = route.pattern;
    found.methods +=
        (found.methods.empty() ? "" : ", ") + (route.method == "GET" ? "GET, HEAD" : route.method);
    if (found.route != nullptr || (route.method != method && method != "OPTIONS")) continue;
    found.route = &route;
    found.by_page = wants_page(request, route);
    request.path_parameters = std::move(*parameters);
  }
  return found;
}

/// What does not look only, changes something or costs time.
Scope Router::Found::scope(const std::string& method) const {
  if (audience() == Audience::monitors) return Scope::metrics;
  const bool looks = method == "GET" || method == "HEAD" || method == "OPTIONS";
  return looks ? Scope::read : Scope::solve;
}

const Route& Router::require(Request& request, const Found& found) const {
  access_.require_known_host(request);
  if (found.wants_token()) request.identity = access_.require(request, found.scope(request.method));
  if (found.methods.empty()) throw not_found();
  if (found.route == nullptr) throw method_not_allowed(request.method, found.methods);
  if (request.method == "OPTIONS" || found.by_page) return *found.route;
  request.reply_type = negotiate(request, *found.route);
  if (found.route->judge_body != nullptr) found.route->judge_body(request);
  return *found.route;
}

bool Router::refuses(Request& request) const {
  try {
    require(request, find(request));
    return false;
  } catch (const HttpError&) {
    return true;
  }
}

Response Router::route(Request& request) const {
  if (request.path == "*") return options("GET, HEAD, POST, DELETE");
  const Found found = find(request);
  if (found.audience() != Audience::probes) access_.count(request);
  if (!found.methods.empty() && access_.cors.is_preflight(request))
    return Cors::answer_preflight(found.methods);
  const Route& route = require(request, found);
  if (found.wants_token()) access_.count(request.identity);
  if (request.method == "OPTIONS") return options(found.methods);
  const SenderFields sender(request);
  if (found.by_page) return route.page(request);
  Response response = route.handler(request);
  const bool looks = request.method == "GET" || request.method == "HEAD";
  return looks ? under_conditions(request, std::move(response)) : response;
}

}  // namespace signorini::server
