#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/http/message_reader.hpp"
#include "server/http/semaphore.hpp"

namespace signorini::server {

/// How long a client may take for a reply, so that none can hold a thread for ever.
struct WriteLimits {
  std::chrono::seconds time{30};    ///< to take some more of it,
  std::uint64_t bytes = 64 * 1024;  ///< this much at least
  std::chrono::seconds slow{5};     ///< in which a client who is in the way of others
  double rate = 16 * 1024;          ///< has to take so many bytes a second
};

/// What came of an attempt to receive.
enum class Receipt { bytes, nothing, closed };

/// How far a client has taken a reply.
enum class Delivery { whole, part, failed };

/// One client's connection, from its acceptance until it is closed or given away.
class Connection {
 public:
  /// The place is kept until it is left, or the connection is closed. `slow_readers` is how many clients may
  /// keep a thread waiting until they take more of a reply; where there are more, the slow ones are left.
  /// Every wait ends when the stop event (an eventfd of the listener) is signalled.
  Connection(int socket, int stop_event, const MessageLimits& limits, Semaphore& slow_readers,
             std::shared_ptr<void> place);
  ~Connection();

  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  int socket() const { return socket_; }
  MessageReader& reader() { return reader_; }
  /// Of the client, in numbers.
  const std::string& remote_address() const { return remote_address_; }
  /// Whether the client has closed the connection, its sending side at least.
  bool has_left() const;
  /// Whether the client takes no more: it has reset the connection, or both sides have closed it.
  bool is_gone() const;

  void keep_place(std::shared_ptr<void> place) { place_ = std::move(place); }

  /// Takes what has come, so many bytes at most, without waiting, and gives it to the reader.
  Receipt receive(std::size_t most = kReceived);

  /// A reply that is sent without waiting, by deliver().
  void put(std::string reply);
  /// Sends as much of it as the client takes at once.
  Delivery deliver();
  /// What is left of it.
  std::size_t undelivered() const { return reply_.size() - delivered_; }

  /// From now on the client is to take a reply that is written meanwhile; others may wait for what that
  /// holds.
  void begin_reply(std::function<bool()> in_the_way);
  /// Sends all of it, and waits until the client has taken it; false if it does not.
  bool send(std::string_view bytes);
  /// Sends as much of it as the client takes at once.
  void send_at_once(std::string_view text) const;
  /// Ends the sending side. What the client sends from now on is read over.
  void end_sending();
  /// When the socket is closed, the system does not keep what the client has not taken either.
  void forget_unsent() const;

  /// The socket, for somebody else to close.
  int give_away();

 private:
  using Clock = std::chrono::steady_clock;

  static constexpr std::size_t kReceived = 16 * 1024;

  bool stopping() const;
  bool wait_writable();
  bool wait_in_place(Clock::time_point until);
  std::uint64_t acknowledged() const;
  bool is_in_the_way();

  std::shared_ptr<void> place_;
  int socket_;
  const std::string remote_address_;
  const int stop_event_;
  const WriteLimits limits_;
  Semaphore& slow_readers_;
  MessageReader reader_;
  bool ended_ = false;
  std::string reply_;
  std::size_t delivered_ = 0;  ///< of it
  std::function<bool()> in_the_way_;
  std::uint64_t sent_ = 0;  ///< in all
  Clock::time_point patient_since_;
  std::uint64_t patient_from_ = 0;  ///< of what was sent
  Clock::time_point paced_since_;
  std::uint64_t paced_from_ = 0;  ///< of what was acknowledged
  bool is_slow_ = false;          ///< its pace, as last seen
};

}  // namespace signorini::server
