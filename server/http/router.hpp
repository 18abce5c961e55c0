#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/access/access.hpp"
#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

using Handler = std::function<Response(const Request&)>;

/// Whom a route is for: clients and monitors show a token if the service wants one; nobody counts how often
/// probes ask.
enum class Audience { clients, monitors, everybody, probes };

/// One line of the route table.
struct Route {
  std::string method;
  std::string pattern;                   ///< e.g. `/v1/solves/{id}/result`
  std::vector<std::string> media_types;  ///< of the reply; 406 if the client takes none; empty: not asked
  Handler handler;
  Audience audience = Audience::clients;
  Length (*length)(const Query& query) = nullptr;  ///< of the reply to such a query; empty: brief
  /// Throws HttpError for a body that the handler would not take, by what the head says of it. Empty: nothing
  /// is asked.
  void (*judge_body)(const Request& request) = nullptr;
  /// Whether it may take long to read what a body brings, however short that is.
  bool is_long_to_read = false;
  /// Answers browsers, which prefer `text/html` to all media types of the reply, by a page. It holds nothing
  /// of any client, so that it is for everybody. Empty: there is none.
  Handler page = nullptr;
};

/// Told of every reply once it is made, those included that no route has given.
using ReplyObserver =
    std::function<void(const Request& request, const Response& response, std::chrono::duration<double> time)>;

/// The route table.
class Router {
 public:
  Router(
      std::vector<Route> routes, Access& access, ReplyObserver observer = [](auto&&...) {})
      : routes_(std::move(routes)), access_(access), observer_(std::move(observer)) {}

  /// Answers the request by its handler; HEAD is answered as GET, and OPTIONS by what the path allows. Throws
  /// HttpError 429, 421, 403, 401, 404, 405 (with Allow), 406 and 415.
  Response route(Request& request) const;

  /// Whether the request will be refused whatever its body says: 401, 404, 405, 406, 415 and the like.
  bool refuses(Request& request) const;

  /// Whether a path is for probes.
  bool is_for_probes(std::string_view path) const;
  /// How long the reply may be.
  Length length(std::string_view method, std::string_view path, const Query& query) const;
  /// Whether it may take long to read what a request brings, however short its body is.
  bool is_long_to_read(std::string_view method, std::string_view path) const;

  /// Tells browsers which pages may read the reply.
  void mark(const Request& request, Response& response) const { access_.cors.mark(request, response); }

  const std::vector<Route>& table() const { return routes_; }

  void replied(const Request& request, const Response& response, std::chrono::duration<double> time) const {
    observer_(request, response, time);
  }

 private:
  /// The routes that have a path.
  struct Found {
    const Route* route = nullptr;  ///< for the method of the request; for OPTIONS the first of them
    std::string methods;           ///< of all of them
    bool by_page = false;          ///< whether the page of the route answers
    Audience audience() const {
      if (by_page) return Audience::everybody;
      return route == nullptr ? Audience::clients : route->audience;
    }
    bool wants_token() const { return audience() == Audience::clients || audience() == Audience::monitors; }
    /// What the token is to be for.
    Scope scope(const std::string& method) const;
  };

  Found find(Request& request) const;
  const Route& require(Request& request, const Found& found) const;

  std::vector<Route> routes_;
  Access& access_;
  ReplyObserver observer_;
};

}  // namespace signorini::server
