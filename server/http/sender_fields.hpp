#pragma once

#include <optional>

#include "server/http/request.hpp"
#include "server/log.hpp"

namespace signorini::server {

/// What the lines that are logged for a request say of who sends it: `address`, and `client` if a token names
/// it.
class SenderFields {
 public:
  explicit SenderFields(const Request& request) : address_("address", request.remote_address) {
    if (!request.identity.name.empty()) name_.emplace("client", request.identity.name);
  }

 private:
  LogField address_;
  std::optional<LogField> name_;
};

}  // namespace signorini::server
