#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/fleet.hpp"

namespace signorini::server {

/// Who is told of what other processes do.
struct LookoutEars {
  /// The jobs and batches that somebody here waits for and that do not run here.
  std::function<std::vector<std::string>()> sought;
  /// A solve has begun; what it does is written into this from now on.
  std::function<void(const std::string& job, const std::shared_ptr<const LiveSolve>& live)> begun;
  /// A job has ended or is gone, or it is a batch, of which something may have ended.
  std::function<void(const std::string& id)> ended;
  /// There may be something to claim.
  std::function<void()> queued;
};

/// Looks now and then, and when another process hints, at what others do with the jobs that somebody here
/// waits for; and hints to others what has been done here, many things by one hint.
class Lookout {
 public:
  Lookout(Fleet& fleet, LookoutEars ears);
  ~Lookout();

  Lookout(const Lookout&) = delete;
  Lookout& operator=(const Lookout&) = delete;

  /// Something was queued or has ended here.
  void hint();

 private:
  void listen(const std::stop_token& stop);
  void look();
  void follow(Found& found);
  void tell(const std::stop_token& stop);
  void pause(const std::stop_token& stop, std::chrono::milliseconds time);

  /// A solve elsewhere, as it is known here.
  struct Mirror {
    std::uint64_t attempt = 0;
    std::size_t known = 0;  ///< iterations
    std::shared_ptr<LiveSolve> live;
  };

  Fleet& fleet_;
  const LookoutEars ears_;
  std::map<std::string, Mirror> mirrors_;  ///< by job; of the listening thread

  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool has_news_ = false;

  std::jthread telling_, listening_;  // the one that ends first is woken by the other
};

}  // namespace signorini::server
