#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "server/jobs/store.hpp"

namespace signorini::server {

/// The results that replies are written from just now. Replies about the same solve share one, and all
/// together take no more memory than a budget, but for a result that is larger by itself.
class SharedResults {
 public:
  /// `patience`: how long a reply waits until others have given memory back.
  SharedResults(JobStore& store, std::size_t max_bytes,
                std::chrono::milliseconds patience = std::chrono::seconds(30))
      : store_(store), max_bytes_(max_bytes), patience_(patience) {}

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

  std::shared_ptr<Place> place_of(const std::string& id);
  void take(std::size_t bytes);
  void give_back(std::size_t bytes);

  JobStore& store_;
  const std::size_t max_bytes_;
  const std::chrono::milliseconds patience_;

  std::mutex mutex_;
  std::condition_variable given_back_;
  std::map<std::string, std::weak_ptr<Place>> places_;  ///< by the id of the job
  std::size_t taken_ = 0;
  std::atomic<int> awaiting_ = 0;
};

}  // namespace signorini::server
