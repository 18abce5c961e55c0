#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace signorini::server {

/// Stands between a client and a socket in the file system, on a free port of the loopback.
class TcpProxy {
 public:
  explicit TcpProxy(std::string socket);
  ~TcpProxy();

  TcpProxy(const TcpProxy&) = delete;
  TcpProxy& operator=(const TcpProxy&) = delete;

  int port() const { return port_; }

  /// Lets nothing through any more, without closing anything: what is sent meanwhile comes when that is over.
  void hold(bool held) { held_ = held; }

 private:
  struct Pair {
    int client, server;
  };

  void run();
  void accept();
  static bool carry(int from, int to);

  const std::string socket_;
  int listener_ = -1, port_ = 0;
  std::vector<Pair> pairs_;
  std::atomic<bool> held_ = false, stopping_ = false;
  std::thread thread_;
};

}  // namespace signorini::server
