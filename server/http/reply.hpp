#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/http/connection.hpp"
#include "server/http/response.hpp"

namespace signorini::server {

/// Whether the connection takes another request after this reply.
bool goes_on(const Message& message, const Response& response);

/// The reply to this request (RFC 9112, 6) in one piece: all of it but for a body that is still to be
/// written, or that somebody else sends.
std::string reply_text(const Message& message, const Response& response);

/// Sends a reply while its body is written; `log_id` names the request where the reply breaks off. False if
/// it does.
bool send_written_reply(Connection& connection, const Message& message, const Response& response,
                        const std::string& log_id);

/// Sends those parts of a reply that there are by now, behind its head if they are the first; the end of the
/// reply too if no more will follow.
Delivery send_parts(Connection& connection, const Message& message, const Response& response, bool first,
                    const std::string& log_id);

}  // namespace signorini::server
