#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace signorini::server {

/// Takes the next piece of a body; false means that the client has gone.
using PieceSink = std::function<bool(std::string_view piece)>;

/// Writes a body piece by piece; returns false if the sink ended it. May be called again, and then begins
/// anew.
using BodyWriter = std::function<bool(const PieceSink& sink)>;

/// One reply: a body that is there, one that is written while it is sent, or one that outlives the exchange.
struct Response {
  int status = 200;
  std::string content_type;
  std::string body;
  BodyWriter write_body;
  std::function<void(int socket)> take_connection;  ///< sends the body itself, from the end of the head on
  std::vector<std::pair<std::string, std::string>> headers;
  std::string job;  ///< id of the job that the reply is about, for the log

  static Response json(int status, std::string text);
  static Response html(std::string text);
  static Response empty(int status);
};

}  // namespace signorini::server
