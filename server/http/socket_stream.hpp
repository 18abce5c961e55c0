#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <httplib.h>

#include "server/http/places.hpp"

namespace signorini::server {

/// How long and how much a client may send, so that none can hold a thread or memory for ever.
struct StreamLimits {
  std::uint64_t head_bytes = 64 * 1024;
  std::chrono::seconds head{10};          ///< for the rest of a head
  std::chrono::seconds body{300};         ///< for a whole body
  std::chrono::seconds write{30};         ///< for the client to take some more of a reply,
  std::uint64_t write_bytes = 64 * 1024;  ///< this much at least
};

/// What came of an attempt to receive.
enum class Receipt { bytes, nothing, closed };

/// The bytes of one connection, with deadlines and counts that httplib's own stream does not have. Every
/// wait ends when the stop event (an eventfd of the listener) is signalled.
class SocketStream : public httplib::Stream {
 public:
  /// `slow_readers` is how many clients may keep a thread waiting until they take more of a reply; one more
  /// is left.
  SocketStream(int socket, int stop_event, const StreamLimits& limits, Places& slow_readers);

  /// Takes what has come, some 16 KiB at most, without waiting.
  Receipt receive();
  /// What has come and was not read yet.
  std::string_view buffered() const { return std::string_view(buffer_).substr(begin_); }
  void forget_buffered();

  /// From now on the head of a request is read.
  void begin_request();
  /// From now on a body of at most so many bytes is read.
  void expect_body(std::uint64_t bytes);
  /// Something to be let go when the body has been read, or will not be.
  void hold_while_body_comes(std::shared_ptr<void> held) { held_for_body_ = std::move(held); }
  void body_is_over() { held_for_body_.reset(); }
  /// Sends what is held back of a reply; false if the client does not take it.
  bool finish_reply();
  /// How much of what was expected has not been read.
  std::uint64_t unread() const { return allowed_; }
  /// Sends as much of it as the client takes at once.
  void send_at_once(std::string_view text) const;
  void end_sending() const;

  bool is_readable() const override;
  bool is_writable() const override;
  ssize_t read(char* data, size_t size) override;
  /// The first write of a reply, which is its head, is held back until the second or the end of the reply, so
  /// that a head and a short body leave in one packet.
  ssize_t write(const char* data, size_t size) override;
  void get_remote_ip_and_port(std::string& ip, int& port) const override;
  void get_local_ip_and_port(std::string& ip, int& port) const override;
  socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  bool stopping() const;
  bool wait_readable(Clock::time_point until) const;
  bool fill();
  bool wait_writable();
  ssize_t send(const char* data, size_t size);
  bool send_held();

  const int socket_;
  const int stop_event_;
  const StreamLimits limits_;
  std::uint64_t allowed_ = 0;
  Clock::time_point deadline_;
  std::string buffer_;
  std::size_t begin_ = 0;
  std::shared_ptr<void> held_for_body_;
  Places& slow_readers_;
  Clock::time_point patient_since_;
  std::uint64_t taken_since_ = 0;
  bool replying_ = false;
  std::string held_;
};

}  // namespace signorini::server
