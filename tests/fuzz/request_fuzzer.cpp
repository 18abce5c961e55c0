#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "server/http/message_reader.hpp"

namespace {

using signorini::server::Message;
using signorini::server::MessageLimits;
using signorini::server::MessageReader;

/// The requests that these bytes are taken for if so many come at a time: each but for the words of a
/// refusal.
std::vector<std::string> read(std::string_view bytes, std::size_t piece) {
  MessageLimits limits;
  limits.body = 300;
  MessageReader reader(limits);
  std::vector<std::string> requests;
  while (!bytes.empty()) {
    reader.take(bytes.substr(0, piece));
    bytes.remove_prefix(std::min(piece, bytes.size()));
    while (reader.stage() == MessageReader::Stage::whole) {
      const Message message = reader.next();
      if (message.refusal) return requests;
      if (message.body.size() > limits.body || message.path.empty()) std::abort();
      requests.push_back(message.method + ' ' + message.host + ' ' + message.path + '\n' + message.body);
      if (!message.may_follow) return requests;
    }
  }
  return requests;
}

}  // namespace

/// Whatever bytes a client sends, and in whatever pieces, they are the same requests.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (read(bytes, size + 1) != read(bytes, 1)) std::abort();
  return 0;
}
