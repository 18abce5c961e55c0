#include "server/http/connection.hpp"

#include <utility>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace signorini::server {
namespace {

constexpr int nobody = -1;

}  // namespace

Connection::Connection(int socket, int stop_event, const StreamLimits& limits, Places& slow_readers,
                       std::shared_ptr<void> place)
    : place_(std::move(place)), socket_(socket), stream_(socket, stop_event, limits, slow_readers) {}

Connection::~Connection() {
  if (socket_ == nobody) return;
  ::shutdown(socket_, SHUT_RDWR);
  ::close(socket_);
}

bool Connection::client_left() const {
  pollfd client{socket_, POLLRDHUP, 0};
  return ::poll(&client, 1, 0) > 0;
}

bool Connection::give_away() {
  if (!taker_) return false;
  taker_(std::exchange(socket_, nobody));
  return true;
}

}  // namespace signorini::server
