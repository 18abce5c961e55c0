#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <string>

namespace signorini::server {

/// What counts as one client: an address, of IPv6 the network of 64 bits.
std::string network_of(const std::string& address);

/// How many requests a client may send: so many a second, and those of one second at once.
class RequestRate {
 public:
  using Clock = std::chrono::steady_clock;

  /// 0: as many as it likes.
  explicit RequestRate(double per_second) : per_second_(per_second) {}

  double per_second() const { return per_second_; }

  /// Counts a request of the client with this address, and returns how long it has to wait before one is
  /// taken: zero if this one is. The addresses of an IPv6 network of 64 bits count as one.
  std::chrono::duration<double> count(const std::string& address, Clock::time_point now);

 private:
  struct Bucket {
    double tokens;
    Clock::time_point filled;
  };

  double burst() const;
  double tokens(const Bucket& bucket, Clock::time_point now) const;
  void forget_quiet_clients(Clock::time_point now);

  const double per_second_;
  std::mutex mutex_;
  std::map<std::string, Bucket> buckets_;
};

}  // namespace signorini::server
