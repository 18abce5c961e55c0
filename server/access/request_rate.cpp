#include "server/access/request_rate.hpp"

#include <algorithm>
#include <array>

#include <arpa/inet.h>

namespace signorini::server {
namespace {

constexpr std::size_t many_clients = 10'000;

}  // namespace

std::string network_of(const std::string& address) {
  in6_addr ipv6{};
  if (inet_pton(AF_INET6, address.c_str(), &ipv6) != 1 || IN6_IS_ADDR_V4MAPPED(&ipv6)) return address;
  return {reinterpret_cast<const char*>(ipv6.s6_addr), 8};
}

std::chrono::duration<double> RequestRate::count(const std::string& address, Clock::time_point now) {
  using Seconds = std::chrono::duration<double>;
  if (per_second_ <= 0) return Seconds(0);
  const std::lock_guard lock(mutex_);
  if (buckets_.size() >= many_clients) forget_quiet_clients(now);
  Bucket& bucket = buckets_.try_emplace(network_of(address), Bucket{burst(), now}).first->second;
  bucket = {tokens(bucket, now), now};
  if (bucket.tokens < 1) return Seconds((1 - bucket.tokens) / per_second_);
  bucket.tokens -= 1;
  return Seconds(0);
}

double RequestRate::burst() const {
  return std::max(1.0, per_second_);
}

double RequestRate::tokens(const Bucket& bucket, Clock::time_point now) const {
  const double seconds = std::chrono::duration<double>(now - bucket.filled).count();
  return std::min(burst(), bucket.tokens + seconds * per_second_);
}

/// One whose bucket is full again is as one who never came.
void RequestRate::forget_quiet_clients(Clock::time_point now) {
  std::erase_if(buckets_, [&](const auto& each) { return tokens(each.second, now) >= burst(); });
}

}  // namespace signorini::server
