#pragma once

#include <cstdint>
#include <string>

#include "server/jobs/share.hpp"

namespace signorini::server {

/// What a token is for.
enum class Scope : std::uint8_t {
  read = 1,     ///< to look at solves and results
  solve = 2,    ///< to send problems, to cancel and delete solves
  admin = 4,    ///< both, and the solves of everybody
  metrics = 8,  ///< to read the metrics; whoever may read may that too
};

/// Who sends a request, as its token tells.
struct Identity {
  std::string name;          ///< empty where the service knows no names
  std::uint8_t scopes = 15;  ///< a Scope each bit
  Share share = {};
  double rate = 0;  ///< requests a second; 0: no limit

  bool sees_all() const { return (scopes & static_cast<std::uint8_t>(Scope::admin)) != 0; }
  bool may(Scope scope) const { return sees_all() || (scopes & static_cast<std::uint8_t>(scope)) != 0; }
  bool may_see_those_of(const std::string& owner) const { return sees_all() || owner == name; }
};

}  // namespace signorini::server
