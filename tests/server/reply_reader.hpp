#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace signorini::server {

/// One reply of a connection, as sent.
struct Reply {
  int status = 0;
  std::string head;  ///< up to the empty line
  std::string body;  ///< without chunks
};

/// The replies that have come to their ends; `to_head` says that the first one answers HEAD. What is no reply
/// counts as one with the status 0.
std::vector<Reply> read_replies(std::string_view heard, bool to_head = false);

}  // namespace signorini::server
