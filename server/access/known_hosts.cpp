#include "server/access/known_hosts.hpp"

#include <algorithm>
#include <cctype>

#include <arpa/inet.h>

#include "server/http/error.hpp"

namespace signorini::server {
namespace {

std::string in_small_letters(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Without port and brackets.
std::string name_of(const std::string& host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return in_small_letters(host.substr(0, host.find(':')));
}

HttpError unknown_host(const std::string& name) {
  return {421,
          {"unknown-host", "Misdirected request",
           "This service listens on this machine only and is not known as `" + name +
               "`. Ask for localhost, or start it with --allow-host " + name +
               " if it is to be reached by that name."}};
}

HttpError foreign_origin(const std::string& origin) {
  return {403,
          {"foreign-origin", "Foreign origin",
           "A page of `" + origin +
               "` sent this request; start the service with --cors-origin if such pages may use it."}};
}

}  // namespace

void KnownHosts::require(const Request& request, const Cors& cors) const {
  if (!names_) return;
  if (!request.host.empty() && !knows(request.host)) throw unknown_host(name_of(request.host));
  const std::optional<std::string> origin = request.header("Origin");
  if (!origin || cors.allows(*origin)) return;
  // A proxy with TLS may be between.
  const std::string host = in_small_letters(request.host);
  const bool own =
      in_small_letters(*origin) == "http://" + host || in_small_letters(*origin) == "https://" + host;
  if (!own) throw foreign_origin(*origin);
}

bool KnownHosts::knows(const std::string& host) const {
  const std::string name = name_of(host);
  return is_loopback(name) ||
         std::ranges::any_of(*names_, [&](const auto& each) { return in_small_letters(each) == name; });
}

bool is_loopback(const std::string& host) {
  if (host == "localhost") return true;
  in_addr ipv4{};
  if (inet_pton(AF_INET, host.c_str(), &ipv4) == 1) return (ntohl(ipv4.s_addr) >> 24) == 127;
  in6_addr ipv6{};
  return inet_pton(AF_INET6, host.c_str(), &ipv6) == 1 && IN6_IS_ADDR_LOOPBACK(&ipv6);
}

}  // namespace signorini::server
