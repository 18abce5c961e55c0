#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace signorini::server {

/// The document as text. Error texts may quote bytes of a client that are no UTF-8; they are replaced
/// rather than thrown about.
inline std::string json_text(const nlohmann::ordered_json& document) {
  return document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace signorini::server
