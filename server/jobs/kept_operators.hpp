#pragma once

#include <cstdint>
#include <list>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "contact/operator.hpp"

namespace signorini::server {

/// The key of an operator (Problem::operator_key) for the jobs of an owner. Names share no operators: that
/// one is at hand would tell one of them what another has solved. Where there are no names, it is as it was;
/// empty stays empty.
std::string operator_key_of(const std::string& owner, const std::string& key);

/// By which an operator is known without its key, which may have megabytes; the same in every process. Of an
/// empty key, and of hardly any other, it is 0.
std::int64_t operator_mark(std::string_view key);

/// What the kept operators have been good for, since the start of the service; and what they hold now.
struct OperatorFigures {
  std::uint64_t hits = 0;
  std::uint64_t misses = 0;
  std::uint64_t evictions = 0;
  std::size_t operators = 0;
  std::size_t bytes = 0;
};

/// The operators of recent solves, shared by all workers (`--cache-bytes`). When they hold more than the
/// limit together, those that have not been used for the longest time are dropped; one that is larger than
/// the limit is not kept at all.
class KeptOperators : public OperatorCache {
 public:
  explicit KeptOperators(std::size_t limit_bytes) : limit_bytes_(limit_bytes) {}

  std::shared_ptr<const Operator> find(const std::string& key) override;
  bool keep(const std::string& key, std::shared_ptr<const Operator> made) override;

  OperatorFigures figures() const;

  /// Of all that are kept.
  std::vector<std::int64_t> marks() const;

 private:
  struct Entry {
    std::string key;
    std::shared_ptr<const Operator> kept;
    std::size_t bytes;
    std::int64_t mark = operator_mark(key);
  };
  using Entries = std::list<Entry>;

  const std::size_t limit_bytes_;
  mutable std::mutex mutex_;
  Entries entries_;                                                 ///< the one used last comes first
  std::unordered_map<std::string_view, Entries::iterator> by_key_;  ///< views of the entries' keys
  OperatorFigures figures_;
};

}  // namespace signorini::server
