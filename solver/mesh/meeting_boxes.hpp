#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

#include "mesh/segments.hpp"

namespace signorini {

struct Box {
  Point low, high;
};

/// The smallest box around a segment, wider by a margin on every side.
inline Box box_around(const Segment& segment, double margin) {
  return {segment[0].cwiseMin(segment[1]).array() - margin, segment[0].cwiseMax(segment[1]).array() + margin};
}

/// Calls visit(i, j) for every pair of boxes that meet, until it returns false.
///
/// A sweep along x: fast where few boxes share an x, quadratic where most of them do.
template <typename Visit>
void for_each_meeting_pair(const std::vector<Box>& boxes, Visit visit) {
  std::vector<int> by_left(boxes.size());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::ranges::sort(by_left, {}, [&](int i) { return std::pair(boxes[i].low.x(), i); });
  for (std::size_t k = 0; k < by_left.size(); ++k) {
    const Box& box = boxes[by_left[k]];
    for (std::size_t l = k + 1; l < by_left.size(); ++l) {
      const Box& other = boxes[by_left[l]];
      if (other.low.x() > box.high.x()) break;
      const bool meet = other.low.y() <= box.high.y() && box.low.y() <= other.high.y();
      if (meet && !visit(by_left[k], by_left[l])) return;
    }
  }
}

}  // namespace signorini
