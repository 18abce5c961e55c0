#include "server/http/listener.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <httplib.h>

#include "server/http/crew.hpp"
#include "server/http/exchange.hpp"
#include "server/http/framing.hpp"
#include "server/http/lobby.hpp"

namespace signorini::server {
namespace {

constexpr int backlog = 1024;

/// httplib's default is SO_REUSEPORT, with which two daemons share a port and nobody notices.
void set_socket_options(socket_t socket) {
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

/// The one whose request this thread answers: httplib passes nothing of ours to its handlers.
thread_local Connection* served_connection = nullptr;

/// Some more than there are cores, for those that wait for the disk.
std::size_t most_at_work() {
  return std::max<std::size_t>(8, 2 * std::thread::hardware_concurrency());
}

/// Of the request line with which these bytes begin, or may begin.
std::string_view path_in(std::string_view bytes) {
  bytes = bytes.substr(0, bytes.find('\r'));
  bytes.remove_prefix(std::min(bytes.find('/'), bytes.size()));
  return bytes.substr(0, bytes.find_first_of(" ?"));
}

bool may_have_body(const std::string& method) {
  return method == "POST" || method == "PUT" || method == "PATCH" || method == "DELETE";
}

/// Runs what it is given at once.
class Immediately : public httplib::TaskQueue {
 public:
  explicit Immediately(std::function<void()> on_shutdown) : on_shutdown_(std::move(on_shutdown)) {}

  void enqueue(std::function<void()> task) override { task(); }
  void shutdown() override { on_shutdown_(); }

 private:
  const std::function<void()> on_shutdown_;
};

/// httplib's server with a connection step of our own: requests are waited for in a lobby, so that a
/// connection has a thread only while it is answered; a stream with limits; and no further request after a
/// body that was not read to its end.
class Server : public httplib::Server {
 public:
  Server(int stop_event, const ListenerOptions& options, const Router& router)
      : stop_event_(stop_event),
        max_body_bytes_(options.max_body_bytes),
        slow_readers_(options.threads / 2),
        crew_(options.threads, most_at_work()),
        probes_crew_(2, 2),
        lobby_(lobby_limits(options), [this, &router](std::shared_ptr<Connection> connection) {
          Crew& crew = router.is_for_probes(path_in(connection->stream().buffered())) ? probes_crew_ : crew_;
          crew.enqueue([this, connection = std::move(connection)] { serve(connection); });
        }) {
    new_task_queue = [this] { return new Immediately([this] { finish(); }); };
  }

  ~Server() override { finish(); }

  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// httplib listens with a backlog of 5; Linux takes a second listen() as a new backlog.
  void deepen_backlog() { ::listen(svr_sock_, backlog); }

 private:
  static LobbyLimits lobby_limits(const ListenerOptions& options) {
    LobbyLimits limits;
    limits.long_bodies = std::max<std::size_t>(1, options.threads / 4);
    return limits;
  }

  bool process_and_close_socket(socket_t socket) override {
    std::shared_ptr<void> place = lobby_.take_place();
    if (!place) {
      ::close(socket);
      return false;
    }
    lobby_.admit(std::make_shared<Connection>(socket, stop_event_, limits_, slow_readers_, std::move(place)));
    return true;
  }

  void serve(const std::shared_ptr<Connection>& connection) {
    served_connection = connection.get();
    SocketStream& stream = connection->stream();
    const bool reusable = serve_one(stream);
    stream.body_is_over();
    if (connection->give_away()) return;
    if (reusable) {
      lobby_.admit(connection);
    } else if (stream.unread() > 0) {
      lobby_.see_off(connection);
    }
  }

  /// False if the connection cannot take another request.
  bool serve_one(SocketStream& stream) {
    bool head_read = false;
    bool reusable = true;
    bool client_closes = false;
    stream.begin_request();
    const bool sent = process_request(stream, false, client_closes, [&](httplib::Request& request) {
      head_read = true;
      reusable = prepare(request, stream);
    });
    return stream.finish_reply() && sent && head_read && reusable && !client_closes && stream.unread() == 0;
  }

  /// Lets the exchanges in progress end.
  void finish() {
    if (finished_.exchange(true)) return;
    lobby_.stop();
    crew_.shutdown();
    probes_crew_.shutdown();
  }

  bool prepare(httplib::Request& request, SocketStream& stream) const {
    const Framing framing = framing_of(request.headers);
    stream.expect_body(raw_bytes(framing));
    sanitize(request);
    // The one route below: our own table does the rest, and no path goes through a regular expression.
    request.path.assign(1, '/');
    return framing.kind != Framing::Kind::chunked && framing.kind != Framing::Kind::ambiguous &&
           request.version != "HTTP/1.0";
  }

  /// How much may be read: chunks may cost up to six bytes for one.
  std::uint64_t raw_bytes(const Framing& framing) const {
    switch (framing.kind) {
      case Framing::Kind::none:
        return 0;
      case Framing::Kind::sized:
        return framing.length;
      default:
        return 8 * static_cast<std::uint64_t>(max_body_bytes_) + 4096;
    }
  }

  const int stop_event_;
  const std::size_t max_body_bytes_;
  const StreamLimits limits_;
  Places slow_readers_;
  Crew crew_;
  Crew probes_crew_;  ///< so that probes are answered however much there is to do
  Lobby lobby_;
  std::atomic<bool> finished_ = false;
};

CannotListen cannot_listen(const ListenerOptions& options) {
  std::string text = "cannot listen on ";
  text.append(options.host).append(":").append(std::to_string(options.port));
  text.append(": the port is taken or not allowed, or the host is not an address of this machine");
  return CannotListen(text);
}

}  // namespace

class Listener::Impl {
 public:
  Impl(const ListenerOptions& options, const Router& router)
      : stop_event_(eventfd(0, EFD_CLOEXEC)), server_(stop_event_, options, router) {
    configure(router);
    port_ = options.port == 0 ? server_.bind_to_any_port(options.host)
                              : (server_.bind_to_port(options.host, options.port) ? options.port : -1);
    if (port_ < 0) {
      ::close(stop_event_);
      throw cannot_listen(options);
    }
    server_.deepen_backlog();
  }

  ~Impl() {
    stop();
    ::close(stop_event_);
  }

  int port() const { return port_; }

  void start(std::function<void()> on_failure) {
    accepting_ = std::thread([this, on_failure = std::move(on_failure)] {
      server_.listen_after_bind();
      ended_ = true;
      if (!stopping_) on_failure();
    });
    // httplib ignores a stop() that comes before it has begun.
    while (!server_.is_running() && !ended_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  void stop() {
    if (stopping_.exchange(true)) return;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(stop_event_, &one, sizeof(one));
    server_.stop();
    if (accepting_.joinable()) accepting_.join();
  }

 private:
  void configure(const Router& router) {
    server_.set_socket_options(set_socket_options);
    server_.set_tcp_nodelay(true);
    server_.set_default_headers({{"Cache-Control", "no-store"},
                                 {"Vary", "Accept, Accept-Encoding"},
                                 {"X-Content-Type-Options", "nosniff"}});
    server_.set_exception_handler(
        [](const httplib::Request&, httplib::Response& to, std::exception_ptr) { to.status = 500; });
    server_.set_error_handler([&router](const httplib::Request& from, httplib::Response& to) {
      explain_refusal(router, from, to);
    });
    server_.set_post_routing_handler(correct_headers);
    route_everything_to(router);
  }

  void route_everything_to(const Router& router) {
    server_.set_pre_routing_handler([&router](const httplib::Request& from, httplib::Response& to) {
      if (may_have_body(from.method)) return httplib::Server::HandlerResponse::Unhandled;
      exchange(router, *served_connection, from, to, nullptr);
      return httplib::Server::HandlerResponse::Handled;
    });
    const auto with_body = [&router](const httplib::Request& from, httplib::Response& to,
                                     const httplib::ContentReader& reader) {
      exchange(router, *served_connection, from, to, &reader);
    };
    server_.Post("/", with_body);
    server_.Put("/", with_body);
    server_.Patch("/", with_body);
    server_.Delete("/", with_body);
  }

  const int stop_event_;
  Server server_;
  int port_ = -1;
  std::atomic<bool> stopping_ = false;
  std::atomic<bool> ended_ = false;
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
