#include "server/http/listener.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <thread>

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/cores.hpp"
#include "server/http/content.hpp"
#include "server/http/dispatch.hpp"
#include "server/http/hatch.hpp"
#include "server/http/pending_connections.hpp"
#include "server/http/query.hpp"
#include "server/http/reply.hpp"
#include "server/http/thread_pool.hpp"
#include "server/http/waiting_room.hpp"

namespace signorini::server {
namespace {

constexpr int backlog = SOMAXCONN;
constexpr int nowhere = -1;

std::size_t one_a_core() {
  return static_cast<std::size_t>(cores());
}

/// Some more than there are cores, for those that wait for the disk.
std::size_t most_at_work() {
  return std::max<std::size_t>(8, 2 * one_a_core());
}

/// Readers of long bodies: one reads while others wait for the disk.
constexpr std::size_t readers = 8;

/// How long a body that has come waits to be read.
constexpr std::chrono::seconds patience_with_bodies{30};

bool is_compressed(const Message& message) {
  return !message.body.empty() && !list_of(message.headers, "Content-Encoding").empty();
}

/// Whether it may take long to read what the message brings, or to decode it.
bool is_long_to_read(const Message& message) {
  return message.body.size() > PendingLimits{}.short_body || is_compressed(message);
}

/// What there is to read, about: JSON becomes so many times as long as it was sent.
std::uint64_t bytes_to_read(const Message& message) {
  constexpr std::uint64_t usual_ratio = 8;
  return is_compressed(message) ? usual_ratio * message.body.size() : message.body.size();
}

PendingLimits pending_limits(const ListenerOptions& options) {
  PendingLimits limits;
  limits.long_bodies = std::max(limits.long_bodies, 2 * options.max_body_bytes);
  return limits;
}

MessageLimits message_limits(const ListenerOptions& options) {
  MessageLimits limits;
  limits.body = options.max_body_bytes;
  return limits;
}

CannotListen cannot_listen(const ListenerOptions& options) {
  std::string text = "cannot listen on ";
  text.append(options.host).append(":").append(std::to_string(options.port));
  text.append(": the port is taken or not allowed, or the host is not an address of this machine");
  return CannotListen(text);
}

/// A socket that listens on the address, or `nowhere`. Without SO_REUSEPORT, with which two daemons would
/// share a port and nobody notice.
int listening_socket(const addrinfo& address) {
  const int socket =
      ::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol);
  if (socket < 0) return nowhere;
  const int yes = 1, no = 0;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  if (address.ai_family == AF_INET6) setsockopt(socket, IPPROTO_IPV6, IPV6_V6ONLY, &no, sizeof(no));
  if (::bind(socket, address.ai_addr, address.ai_addrlen) == 0 && ::listen(socket, backlog) == 0)
    return socket;
  ::close(socket);
  return nowhere;
}

/// Throws CannotListen.
int listening_socket(const ListenerOptions& options) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(options.host.c_str(), std::to_string(options.port).c_str(), &hints, &found) != 0) {
    throw cannot_listen(options);
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  int socket = nowhere;
  for (const addrinfo* each = found; each != nullptr && socket == nowhere; each = each->ai_next) {
    socket = listening_socket(*each);
  }
  if (socket == nowhere) throw cannot_listen(options);
  return socket;
}

int port_of(int socket) {
  sockaddr_storage address{};
  socklen_t length = sizeof(address);
  auto* generic = reinterpret_cast<sockaddr*>(&address);
  std::array<char, NI_MAXSERV> service{};
  if (::getsockname(socket, generic, &length) != 0) return nowhere;
  getnameinfo(generic, length, nullptr, 0, service.data(), service.size(), NI_NUMERICSERV);
  return std::atoi(service.data());
}

/// A request and the way back to its client.
struct Exchange {
  std::shared_ptr<Connection> connection;
  Message message;
  Request request;
};

/// For a client who need not be there any more.
Task task_of(const Connection& connection, std::function<void()> work) {
  return {std::move(work), network_of(connection.remote_address()), std::chrono::steady_clock::now()};
}

/// For a client who takes the reply, though it may have closed its sending side.
Task reply_to(const std::shared_ptr<Connection>& connection, std::function<void()> work) {
  Task task = task_of(*connection, std::move(work));
  task.is_unwanted = [connection] { return connection->is_gone(); };
  return task;
}

/// For a client who has to be there still, in the order in which bodies are read.
Task reading_of(const std::shared_ptr<Connection>& connection, std::function<void()> work) {
  Task task = task_of(*connection, std::move(work));
  task.due = due(task.due, bytes_to_read(connection->reader().message()));
  task.is_unwanted = [connection] { return connection->has_left(); };
  return task;
}

}  // namespace

/// Connections are pending until a request has come, wait in the waiting room until a reply can be made, and
/// at the hatch until it is taken; thread pools answer them between.
class Listener::Impl {
 public:
  Impl(const ListenerOptions& options, const Router& router)
      : socket_(listening_socket(options)),
        port_(port_of(socket_)),
        stop_event_(eventfd(0, EFD_CLOEXEC)),
        router_(router),
        message_limits_(message_limits(options)),
        slow_readers_(options.long_replies / 2),
        pool_(most_at_work(), most_at_work()),
        probe_pool_(2, 2),
        // What is read, written or compressed for long keeps a core busy.
        takers_(most_at_work(), one_a_core()),
        readers_(readers, 1),
        carriers_(options.long_replies, one_a_core()),
        list_carriers_(options.long_replies, one_a_core()),
        hatch_({},
               [this](std::shared_ptr<Connection> connection, bool goes_on) {
                 connection->keep_place(pending_.take_place());
                 move_on(std::move(connection), goes_on);
               }),
        pending_(
            pending_limits(options),
            [this](Connection& connection) {
              Request request = request_of(connection, connection.reader().message());
              return router_.refuses(request);
            },
            [this](const std::shared_ptr<Connection>& connection, std::shared_ptr<void> body_room) {
              take_in(connection, std::move(body_room));
            }) {}

  ~Impl() {
    stop();
    ::close(socket_);
    ::close(stop_event_);
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  int port() const { return port_; }

  void start(std::function<void()> on_failure) {
    accepting_ = std::thread([this, on_failure = std::move(on_failure)] {
      if (!accept_until_stopped()) on_failure();
    });
  }

  void stop() {
    if (stopping_.exchange(true)) return;
    ::eventfd_write(stop_event_, 1);
    if (accepting_.joinable()) accepting_.join();
    pending_.stop();
    waiting_room_.stop();
    for (ThreadPool* pool : {&probe_pool_, &takers_, &readers_, &pool_, &carriers_, &list_carriers_})
      pool->shutdown();
    hatch_.stop();
  }

 private:
  /// False if the socket accepts no more.
  bool accept_until_stopped() {
    constexpr auto pause = std::chrono::milliseconds(10);
    for (;;) {
      std::array<pollfd, 2> polled{{{socket_, POLLIN, 0}, {stop_event_, POLLIN, 0}}};
      ::poll(polled.data(), polled.size(), -1);
      if (stopping_) return true;
      const int socket = ::accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC);
      if (socket >= 0) {
        welcome(socket);
      } else if (errno == EBADF || errno == EINVAL || errno == ENOTSOCK) {
        return false;
      } else if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
        std::this_thread::sleep_for(pause);
      }
    }
  }

  void welcome(int socket) {
    // The system would keep megabytes of replies for a client who reads none.
    const int yes = 1, most_unsent = 128 * 1024;
    setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    setsockopt(socket, IPPROTO_TCP, TCP_NOTSENT_LOWAT, &most_unsent, sizeof(most_unsent));
    std::shared_ptr<void> place = pending_.take_place();
    if (!place) {
      ::close(socket);
      return;
    }
    pending_.admit(
        std::make_shared<Connection>(socket, stop_event_, message_limits_, slow_readers_, std::move(place)));
  }

  /// What reads a body, or refuses a request, does not stand before those who only look.
  void take_in(const std::shared_ptr<Connection>& connection, std::shared_ptr<void> body_room) {
    const Message& message = connection->reader().message();
    const auto came = std::chrono::steady_clock::now();
    const auto serve_by = [&](ThreadPool& pool) {
      return [this, &pool, connection, body_room = std::move(body_room), came] {
        serve(pool, connection, body_room, came);
      };
    };
    if (!message.body.empty()) {
      const bool is_long = is_long_to_read(message) || router_.is_long_to_read(message.method, message.path);
      ThreadPool& pool = is_long ? readers_ : takers_;
      pool.enqueue(reading_of(connection, serve_by(pool)));
    } else {
      ThreadPool& pool = message.refusal ? takers_ : pool_for_reply(message);
      pool.enqueue(reply_to(connection, serve_by(pool)));
    }
  }

  Length length_of_reply(const Message& message) const {
    return router_.length(message.method, message.path, read_query(message.query));
  }

  ThreadPool& pool_for_reply(const Message& message) {
    if (router_.is_for_probes(message.path)) return probe_pool_;
    const Length length = length_of_reply(message);
    return length == Length::result ? carriers_ : length == Length::list ? list_carriers_ : pool_;
  }

  /// A long body has its room until it was read by the handler, or will not be.
  void serve(const ThreadPool& pool, const std::shared_ptr<Connection>& connection,
             std::shared_ptr<void> body_room, std::chrono::steady_clock::time_point came) {
    if (carries(pool) && connection->has_left()) return move_on(connection, false);
    const auto exchange = std::make_shared<Exchange>();
    exchange->connection = connection;
    exchange->message = connection->reader().next();
    exchange->request = request_of(*connection, exchange->message);
    exchange->request.client_left = [&connection] { return connection->has_left(); };
    exchange->request.read_body = [&message = exchange->message, &body_room](std::size_t max_bytes) {
      if (message.body_left)
        throw bad_request("The body was not waited for, as the request was to be refused.");
      std::string body =
          decoded(std::exchange(message.body, {}), list_of(message.headers, "Content-Encoding"), max_bytes);
      body_room.reset();
      return body;
    };
    std::optional<HttpError>& refusal = exchange->message.refusal;
    if (!exchange->message.body.empty() && std::chrono::steady_clock::now() > came + patience_with_bodies)
      refusal = too_many_bodies();
    Response response =
        refusal ? refuse(router_, exchange->request, *refusal) : dispatch(router_, exchange->request);
    exchange->request.read_body = nullptr;
    exchange->request.client_left = nullptr;
    exchange->message.body = {};
    body_room.reset();
    if (response.later) return keep_waiting(exchange, response.later);
    reply(pool, exchange, std::move(response));
  }

  void keep_waiting(const std::shared_ptr<Exchange>& exchange,
                    const std::shared_ptr<const LaterReply>& promised) {
    exchange->connection->keep_place(nullptr);
    waiting_room_.add(
        exchange->connection->socket(), promised->until, promised->subscribe,
        [this, exchange, promised](bool client_left) {
          ThreadPool& pool = client_left ? takers_ : pool_for_reply(exchange->message);
          pool.enqueue(task_of(*exchange->connection, [this, &pool, exchange, promised, client_left] {
            if (client_left) return leave(exchange->request, *promised);
            Response response = resume(router_, exchange->request, *promised);
            exchange->connection->keep_place(pending_.take_place());
            reply(pool, exchange, std::move(response));
          }));
        });
  }

  /// By the pool at hand, but what is long by those who carry such. Once all carriers have begun a result,
  /// nothing else is begun until most have ended: a list would wait for seconds.
  void reply(const ThreadPool& pool, const std::shared_ptr<Exchange>& exchange, Response response) {
    Connection& connection = *exchange->connection;
    const Message& message = exchange->message;
    if (response.take_connection) {
      std::string head = reply_text(message, response);
      return response.take_connection(connection.give_away(), std::move(head));
    }
    if (response.parts && message.method != "HEAD")
      return carry_parts_by_a_carrier(exchange, std::make_shared<const Response>(std::move(response)), true);
    if (response.write_body && message.method != "HEAD") {
      ThreadPool& carriers = length_of_reply(message) == Length::result ? carriers_ : list_carriers_;
      if (&pool == &carriers) return carry(*exchange, response);
      return carriers.enqueue(task_of(
          connection, [this, exchange, response = std::move(response)] { carry(*exchange, response); }));
    }
    connection.keep_place(nullptr);
    hatch_.deliver(exchange->connection, reply_text(message, response), goes_on(message, response));
  }

  /// Whether its replies are long.
  bool carries(const ThreadPool& pool) const { return &pool == &carriers_ || &pool == &list_carriers_; }

  /// A reply that is written while it is sent, if anybody is there for it.
  void carry(const Exchange& exchange, const Response& response) {
    if (exchange.connection->has_left()) return move_on(exchange.connection, false);
    const bool sent =
        send_written_reply(*exchange.connection, exchange.message, response, exchange.request.id);
    move_on(exchange.connection, sent && goes_on(exchange.message, response));
  }

  void carry_parts_by_a_carrier(const std::shared_ptr<Exchange>& exchange,
                                const std::shared_ptr<const Response>& response, bool first) {
    carriers_.enqueue(task_of(*exchange->connection,
                              [this, exchange, response, first] { carry_parts(exchange, response, first); }));
  }

  /// Those that there are by now. The next ones are waited for without a thread, and without a place among
  /// the pending connections.
  void carry_parts(const std::shared_ptr<Exchange>& exchange, const std::shared_ptr<const Response>& response,
                   bool first) {
    const std::shared_ptr<Connection>& connection = exchange->connection;
    const Delivery delivery =
        send_parts(*connection, exchange->message, *response, first, exchange->request.id);
    if (delivery != Delivery::part || stopping_) {
      connection->keep_place(pending_.take_place());
      return move_on(connection, delivery == Delivery::whole && goes_on(exchange->message, *response));
    }
    connection->keep_place(nullptr);
    // Something may be gone without a word.
    constexpr std::chrono::minutes look_again{1};
    waiting_room_.add(
        connection->socket(), std::chrono::steady_clock::now() + look_again,
        [response](std::function<void()> ready) { return response->parts->subscribe(std::move(ready)); },
        [this, exchange, response](bool client_left) {
          if (!client_left) return carry_parts_by_a_carrier(exchange, response, false);
          carriers_.enqueue(
              task_of(*exchange->connection, [this, exchange] { move_on(exchange->connection, false); }));
        });
  }

  void move_on(std::shared_ptr<Connection> connection, bool goes_on) {
    goes_on ? pending_.admit(std::move(connection)) : pending_.linger(std::move(connection));
  }

  const int socket_;
  const int port_;
  const int stop_event_;
  const Router& router_;
  const MessageLimits message_limits_;
  Semaphore slow_readers_;
  ThreadPool pool_;        ///< for those who look, and are answered shortly
  ThreadPool probe_pool_;  ///< so that probes are answered however much there is to do
  ThreadPool takers_;      ///< of short bodies, each of which may cost more than many looks
  ThreadPool
      readers_;  ///< of long bodies, one at a time: each may take tenths of a second and a hundred megabytes
  ThreadPool carriers_;  ///< of long replies, so that short ones do not wait for them
  ThreadPool
      list_carriers_;  ///< of those found long when they are made, which are so much shorter than results
  WaitingRoom waiting_room_;
  Hatch hatch_;
  PendingConnections pending_;
  std::atomic<bool> stopping_ = false;
  std::thread accepting_;
};

Listener::Listener(const ListenerOptions& options, const Router& router)
    : impl_(std::make_unique<Impl>(options, router)) {}

Listener::~Listener() = default;

int Listener::port() const {
  return impl_->port();
}

void Listener::start(std::function<void()> on_failure) {
  impl_->start(std::move(on_failure));
}

void Listener::stop() {
  impl_->stop();
}

}  // namespace signorini::server
