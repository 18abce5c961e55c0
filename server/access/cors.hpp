#pragma once

#include <string>
#include <vector>

#include "server/http/request.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// Which pages of other origins a browser lets talk with the service (the Fetch standard). None by default.
class Cors {
 public:
  Cors() = default;
  /// Origins such as `https://example.org`; `*` is every one.
  explicit Cors(std::vector<std::string> origins) : origins_(std::move(origins)) {}

  /// Whether a browser asks before it sends a request of a page that may send it.
  bool is_preflight(const Request& request) const;
  /// `methods` are those that the path knows.
  static Response answer_preflight(const std::string& methods);

  /// Tells the browser that the page may read the reply, if it may.
  void mark(const Request& request, Response& response) const;

  bool allows(const std::string& origin) const;

 private:
  std::vector<std::string> origins_;
};

}  // namespace signorini::server
