#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "server/jobs/store.hpp"

namespace signorini::server {

/// The results that replies are written from just now. Replies about the same solve share one, and all
/// together take no more memory than a budget, but for a result that is larger by itself. Reading a large one
/// takes long, and who has asked for a part of it mostly asks for another: as long as nobody waits for
/// memory, each lingers for a moment.
class SharedResults {
 public:
  /// `patience`: how long a reply waits until others have given memory back; `linger`: how long a result
  /// stays when the last reply has been written.
  SharedResults(JobStore& store, std::size_t max_bytes,
                std::chrono::milliseconds patience = std::chrono::seconds(30),
                std::chrono::milliseconds linger = std::chrono::milliseconds(500));

  SharedResults(const SharedResults&) = delete;
  SharedResults& operator=(const SharedResults&) = delete;

  /// As JobStore::result(). The result counts until the last copy of it is gone, which this must outlive.
  /// Throws HttpError 503 if there is no memory for it in time.
  std::optional<JobResult> get(const std::string& id);

  /// Whether somebody waits for memory.
  bool are_awaited() const { return awaiting_ > 0; }

 private:
  class Held;

  /// Where those meet who want the same result.
  struct Place {
    std::mutex reading;
    std::weak_ptr<const Held> held;
  };

  struct Lingering {
    std::shared_ptr<const Held> held;
    std::chrono::steady_clock::time_point until;
  };

  std::shared_ptr<Place> place_of(const std::string& id);
  void linger(std::shared_ptr<const Held> held);
  void let_go(const std::stop_token& stop);
  void take(std::size_t bytes);
  void give_back(std::size_t bytes);

  JobStore& store_;
  const std::size_t max_bytes_;
  const std::chrono::milliseconds patience_, linger_;

  std::mutex mutex_;
  std::condition_variable given_back_;
  std::condition_variable_any lingers_;
  std::map<std::string, std::weak_ptr<Place>> places_;  ///< by the id of the job
  std::size_t taken_ = 0;
  std::atomic<int> awaiting_ = 0;
  std::vector<Lingering> lingering_;  ///< in the order of their ends; none while somebody waits for memory
  std::jthread keeper_;               ///< lets them go in time; it ends before the rest does
};

}  // namespace signorini::server
