#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "server/http/router.hpp"

namespace signorini::server {

/// The address cannot be listened on.
class CannotListen : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct ListenerOptions {
  std::string host = "127.0.0.1";
  int port = 0;                   ///< 0: a free one
  std::size_t long_replies = 64;  ///< that are sent at the same time
  std::size_t max_body_bytes = 16 << 20;
};

/// Serves a route table over HTTP/1.1.
class Listener {
 public:
  /// Binds the address. Throws CannotListen.
  Listener(const ListenerOptions& options, const Router& router);
  ~Listener();

  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  int port() const;

  /// Accepts connections from now on; `on_failure` is called if that ends by itself.
  void start(std::function<void()> on_failure);

  /// Accepts no more, lets the exchanges in progress end, closes idle connections, joins all threads.
  void stop();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace signorini::server
