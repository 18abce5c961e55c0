#include "server/jobs/memory_budget.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <sstream>
#include <vector>

namespace signorini::server {

namespace {

MemoryFull full(double bytes, double together, double limit, const std::string& whose,
                const std::string& flag) {
  std::ostringstream text;
  text.precision(3);
  text << "The problem would take about " << bytes / 1e9 << " GB of memory, and " << together / 1e9
       << " GB together with the largest solves" << whose << " that may run at the same time; the limit is "
       << limit / 1e9 << " GB (" << flag << "). Try again when they have ended, or take a coarser mesh.";
  return MemoryFull(text.str());
}

}  // namespace

void MemoryBudget::admit(const std::string& job, double bytes, const std::string& owner,
                         const std::optional<double>& share) {
  const std::lock_guard lock(mutex_);
  taken_[job] = {bytes, owner};
  const double together = largest();
  const double of_owner = share ? largest(owner) : 0;
  if (together <= max_bytes_ && (!share || of_owner <= *share)) return;
  taken_.erase(job);
  if (together > max_bytes_) throw full(bytes, together, max_bytes_, "", "--max-memory");
  throw full(bytes, of_owner, *share, " of `" + owner + "`", "memory= in the token file");
}

void MemoryBudget::require_alone(double bytes, const std::string& owner,
                                 const std::optional<double>& share) const {
  if (bytes > max_bytes_) throw full(bytes, bytes, max_bytes_, "", "--max-memory");
  if (share && bytes > *share)
    throw full(bytes, bytes, *share, " of `" + owner + "`", "memory= in the token file");
}

void MemoryBudget::add(const std::string& job, double bytes, const std::string& owner) {
  const std::lock_guard lock(mutex_);
  taken_[job] = {bytes, owner};
}

double MemoryBudget::left() const {
  const std::lock_guard lock(mutex_);
  return max_bytes_ - largest();
}

double MemoryBudget::left_for(const std::string& job) const {
  const std::lock_guard lock(mutex_);
  const auto own = taken_.find(job);
  const double predicted = own == taken_.end() ? 0 : own->second.bytes;
  return std::max(predicted, max_bytes_ - (largest() - predicted));
}

bool MemoryBudget::knows(const std::string& job) const {
  const std::lock_guard lock(mutex_);
  return taken_.contains(job);
}

void MemoryBudget::release(const std::string& job) {
  const std::lock_guard lock(mutex_);
  taken_.erase(job);
}

/// Of as many jobs as may run, those of one owner if one is given, the largest ones.
double MemoryBudget::largest(const std::optional<std::string>& owner) const {
  std::vector<double> all;
  all.reserve(taken_.size());
  for (const auto& [job, taken] : taken_)
    if (!owner || taken.owner == *owner) all.push_back(taken.bytes);
  const auto end = all.begin() + static_cast<std::ptrdiff_t>(std::min(workers_, all.size()));
  std::partial_sort(all.begin(), end, all.end(), std::greater<>());
  return std::accumulate(all.begin(), end, 0.0);
}

}  // namespace signorini::server
