#include "server/jobs/memory_budget.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <sstream>
#include <vector>

namespace signorini::server {

void MemoryBudget::admit(const std::string& job, double bytes) {
  const std::lock_guard lock(mutex_);
  bytes_[job] = bytes;
  const double together = largest();
  if (together <= max_bytes_) return;
  bytes_.erase(job);
  std::ostringstream text;
  text.precision(3);
  text << "The problem would take about " << bytes / 1e9 << " GB of memory, and " << together / 1e9
       << " GB together with the largest solves that may run at the same time; the limit is "
       << max_bytes_ / 1e9 << " GB (--max-memory). Try again when they have ended, or take a coarser mesh.";
  throw MemoryFull(text.str());
}

void MemoryBudget::add(const std::string& job, double bytes) {
  const std::lock_guard lock(mutex_);
  bytes_[job] = bytes;
}

bool MemoryBudget::knows(const std::string& job) const {
  const std::lock_guard lock(mutex_);
  return bytes_.contains(job);
}

void MemoryBudget::release(const std::string& job) {
  const std::lock_guard lock(mutex_);
  bytes_.erase(job);
}

/// Of as many jobs as may run, the largest ones.
double MemoryBudget::largest() const {
  std::vector<double> all;
  all.reserve(bytes_.size());
  for (const auto& [job, bytes] : bytes_) all.push_back(bytes);
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(workers_, all.size()));
  std::partial_sort(all.begin(), end, all.end(), std::greater<>());
  return std::accumulate(all.begin(), end, 0.0);
}

}  // namespace signorini::server
