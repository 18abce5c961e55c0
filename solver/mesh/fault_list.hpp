#pragma once

#include <string>

#include "problem/field.hpp"

namespace signorini {

/// Faults of one kind. Behind the tenth they are only counted, so that a mesh with a million of them is
/// refused in a reply that can be read.
class FaultList {
 public:
  /// `where` has the offenders as its elements, and `what` names them: `more points that repeat another`.
  FaultList(std::string where, std::string what) : where_(std::move(where)), what_(std::move(what)) {}

  void add(std::string where, std::string detail) {
    if (++count_ <= most) faults_.push_back({std::move(where), std::move(detail)});
  }

  bool is_full() const { return count_ >= most; }
  bool is_empty() const { return count_ == 0; }

  /// Appends the faults, and the count of those that are not listed.
  void append_to(std::vector<Fault>& all) && {
    if (count_ > most)
      faults_.push_back({std::move(where_), "there are " + std::to_string(count_ - most) + ' ' + what_});
    all.insert(all.end(), faults_.begin(), faults_.end());
  }

 private:
  static constexpr int most = 10;
  std::string where_, what_;
  std::vector<Fault> faults_;
  int count_ = 0;
};

}  // namespace signorini
