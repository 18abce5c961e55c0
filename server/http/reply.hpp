#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/http/connection.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// The head of the last reply on a connection, with the length of the body that follows.
std::string reply_head(const Response& response, std::uint64_t length);

/// Sends the reply to this request (RFC 9112, 6); `log_id` names the request where the reply breaks off.
/// False if the connection cannot take another request.
bool send_reply(Connection& connection, const Message& message, const Response& response,
                const std::string& log_id);

}  // namespace signorini::server
