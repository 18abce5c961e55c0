#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "server/http/message.hpp"

namespace signorini::server {

/// How much one request may hold; what is longer is refused.
struct MessageLimits {
  std::size_t head = 16 * 1024;        ///< bytes of request line and headers; also of trailers
  std::size_t target = 8192;           ///< bytes
  std::size_t headers = 128;           ///< and trailers
  std::size_t chunk_line = 1024;       ///< bytes of a chunk's size and extensions
  std::size_t extensions = 16 * 1024;  ///< bytes of all of them in one body
  std::size_t body = 16 << 20;         ///< bytes, without transfer coding
};

/// Reads the requests of one connection out of its bytes, as they come: the one place that knows where a
/// request ends. Boost.Beast's parser reads the grammar, message.hpp has what the RFCs ask beyond.
class MessageReader {
 public:
  explicit MessageReader(const MessageLimits& limits);
  ~MessageReader();

  MessageReader(const MessageReader&) = delete;
  MessageReader& operator=(const MessageReader&) = delete;

  /// What the client has sent of a request.
  enum class Stage {
    nothing,
    head,   ///< some of it
    body,   ///< the head and perhaps some of the body
    whole,  ///< or as much as it takes to refuse it
  };
  Stage stage() const { return stage_; }

  /// Takes more bytes. What comes after the end of the request is kept for the next.
  void take(std::string_view bytes);

  /// The request, as far as its head is there.
  const Message& message() const { return message_; }
  /// How many bytes of the body are still to come; 0 if the client does not say so before.
  std::uint64_t awaited() const;
  /// What the body, of which the head is there, may come to.
  std::uint64_t longest_body() const;
  /// Whether the client sends no body before it is told to go on.
  bool expects_continue() const;
  void told_to_continue() { expects_continue_ = false; }

  /// The rest of the body is not waited for: the message is whole without it, and the last one.
  void leave_body();
  /// The same of all that has not come: the message is refused.
  void refuse(const HttpError& reason);

  /// The whole request. Begins with the next one, which may be there already.
  Message next();

  /// Bytes that are held.
  std::size_t size() const;

 private:
  class Parser;

  void advance();
  void look_for_end_of_head();
  void skip_empty_line();
  void read_head(std::size_t size);
  void read_body();
  void judge_rest_of_chunks() const;
  void end_message();

  const MessageLimits limits_;
  std::string bytes_;        ///< that no one has read
  std::size_t scanned_ = 0;  ///< of them, while they are of a head
  std::size_t line_ends_ = 0;
  std::size_t empty_lines_ = 0;
  std::size_t head_bytes_ = 0;  ///< of the head that was read
  Stage stage_ = Stage::nothing;
  bool expects_continue_ = false;
  bool ended_ = false;  ///< where the next request begins is not known, or not asked
  Message message_;
  std::unique_ptr<Parser> parser_;  ///< while a head or body is read
};

}  // namespace signorini::server
