#pragma once

#include <functional>

#include "server/http/socket_stream.hpp"

namespace signorini::server {

/// One client's connection, from its acceptance until it is closed or given away.
class Connection {
 public:
  /// The place is kept as long as the connection is.
  Connection(int socket, int stop_event, const StreamLimits& limits, Places& slow_readers,
             std::shared_ptr<void> place);
  ~Connection();

  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  SocketStream& stream() { return stream_; }

  /// Whether the client has closed it, its sending side at least.
  bool client_left() const;

  /// Who is to have the socket after this exchange, and will close it.
  void give_away_to(std::function<void(int socket)> taker) { taker_ = std::move(taker); }

  /// Gives the socket away if somebody is to have it.
  bool give_away();

 private:
  const std::shared_ptr<void> place_;
  int socket_;
  SocketStream stream_;
  std::function<void(int socket)> taker_;
};

}  // namespace signorini::server
