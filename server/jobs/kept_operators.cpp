#include "server/jobs/kept_operators.hpp"

#include "progress/memory_meter.hpp"

namespace signorini::server {

/// No name has a line break.
std::string operator_key_of(const std::string& owner, const std::string& key) {
  return owner.empty() || key.empty() ? key : owner + "\n" + key;
}

/// FNV-1a.
std::int64_t operator_mark(std::string_view key) {
  if (key.empty()) return 0;
  std::uint64_t mark = 14695981039346656037u;
  for (const char c : key) mark = (mark ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return static_cast<std::int64_t>(mark);
}

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

bool KeptOperators::keep(const std::string& key, std::shared_ptr<const Operator> made) {
  const std::size_t bytes = made->bytes() + key.size();
  if (bytes > limit_bytes_) return false;
  // Neither the key and its entry nor what is dropped for them are the solve's.
  const Unmetered cache;
  Entries dropped;  // their memory is freed after the lock is
  const std::lock_guard lock(mutex_);
  if (by_key_.contains(key)) return false;  // another worker made it at the same time
  entries_.push_front({key, std::move(made), bytes});
  by_key_.emplace(entries_.front().key, entries_.begin());
  figures_.bytes += bytes;
  while (figures_.bytes > limit_bytes_) {
    ++figures_.evictions;
    figures_.bytes -= entries_.back().bytes;
    by_key_.erase(entries_.back().key);
    dropped.splice(dropped.begin(), entries_, std::prev(entries_.end()));
  }
  return true;
}

OperatorFigures KeptOperators::figures() const {
  const std::lock_guard lock(mutex_);
  OperatorFigures figures = figures_;
  figures.operators = entries_.size();
  return figures;
}

std::vector<std::int64_t> KeptOperators::marks() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::int64_t> marks;
  for (const Entry& entry : entries_) marks.push_back(entry.mark);
  return marks;
}

}  // namespace signorini::server
