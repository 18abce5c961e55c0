#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/access/cors.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// By which names browsers may reach a service that listens on this machine only. Whoever has a domain can
/// let its name mean 127.0.0.1 (DNS rebinding), and to a browser its pages and the service are then one site;
/// any page can send requests here whose replies it cannot read.
class KnownHosts {
 public:
  /// All of them.
  KnownHosts() = default;
  /// Those of the loopback, and these.
  explicit KnownHosts(std::vector<std::string> names) : names_(std::move(names)) {}

  /// Throws HttpError 421 if the request is for another host, and 403 if it is sent by a page of another
  /// origin that is not let in. Who says neither is no browser.
  void require(const Request& request, const Cors& cors) const;

 private:
  bool knows(const std::string& host) const;

  std::optional<std::vector<std::string>> names_;
};

/// Whether a host is reached from this machine only: `localhost`, 127.0.0.0/8 and ::1.
bool is_loopback(const std::string& host);

}  // namespace signorini::server
