#include "server/health_command.hpp"

#include <iostream>

#include <httplib.h>

#include "server/exit_code.hpp"

namespace signorini::server {
namespace {

/// Where a service that listens on the address is to be found from this machine.
std::string reachable(const std::string& host) {
  if (host == "0.0.0.0") return "127.0.0.1";
  return host == "::" ? "::1" : host;
}

}  // namespace

int run_health(const DaemonConfig& config) {
  httplib::Client client(reachable(config.host), config.port);
  client.set_connection_timeout(2);
  client.set_read_timeout(2);
  const httplib::Result reply = client.Get("/healthz");
  if (reply && reply->status == 200) return exit_done;
  std::cerr << "no service answers on " << config.host << " port " << config.port << ": "
            << (reply ? "status " + std::to_string(reply->status) : httplib::to_string(reply.error()))
            << std::endl;
  return exit_failed;
}

}  // namespace signorini::server
