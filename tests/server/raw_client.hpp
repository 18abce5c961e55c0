#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace signorini::server {

/// A client that says what it likes, byte by byte, and keeps what it hears.
class RawClient {
 public:
  explicit RawClient(int port);
  ~RawClient();

  RawClient(RawClient&& other) noexcept;
  RawClient& operator=(RawClient&&) = delete;

  /// From now on the system takes little for it.
  void turn_deaf() const;
  /// False if the service does not take it any more.
  bool send(const std::string& bytes) const;
  /// Says that nothing more comes, and stays.
  void end_sending() const;
  /// Takes what has come, without waiting.
  void receive();
  void close();

  int socket() const { return socket_; }
  bool closed() const { return closed_; }  ///< by the service
  const std::string& heard() const { return heard_; }
  /// Of the first reply; 0 if there is none yet.
  int status() const;

 private:
  int socket_;
  bool closed_ = false;
  std::string heard_;
};

/// Until something comes to one of them, or they are closed.
void wait_for_bytes(const std::vector<RawClient>& clients, std::chrono::milliseconds time);

/// Takes what comes to the clients until the condition holds; false if the time is over before.
template <typename Condition>
bool listen_until(std::vector<RawClient>& clients, std::chrono::milliseconds time,
                  const Condition& condition) {
  const auto until = std::chrono::steady_clock::now() + time;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) return false;
    wait_for_bytes(clients, std::chrono::milliseconds(20));
    for (RawClient& client : clients) client.receive();
  }
  return true;
}

}  // namespace signorini::server
