#include "server/jobs/kept_operators.hpp"

namespace signorini::server {

std::shared_ptr<const Operator> KeptOperators::find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto found = by_key_.find(key);
  if (found == by_key_.end()) {
    ++figures_.misses;
    return nullptr;
  }
  ++figures_.hits;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->kept;
}

void KeptOperators::keep(const std::string& key, std::shared_ptr<const Operator> made) {
  const std::size_t bytes = made->bytes() + key.size();
  if (bytes > limit_bytes_) return;
  Entries dropped;  // their memory is freed after the lock is
  const std::lock_guard lock(mutex_);
  if (by_key_.contains(key)) return;  // another worker made it at the same time
  entries_.push_front({key, std::move(made), bytes});
  by_key_.emplace(entries_.front().key, entries_.begin());
  figures_.bytes += bytes;
  while (figures_.bytes > limit_bytes_) {
    ++figures_.evictions;
    figures_.bytes -= entries_.back().bytes;
    by_key_.erase(entries_.back().key);
    dropped.splice(dropped.begin(), entries_, std::prev(entries_.end()));
  }
}

OperatorFigures KeptOperators::figures() const {
  const std::lock_guard lock(mutex_);
  OperatorFigures figures = figures_;
  figures.operators = entries_.size();
  return figures;
}

}  // namespace signorini::server
