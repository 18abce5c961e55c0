#pragma once

#include <algorithm>
#include <array>
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

inline Box wider(const Box& box, double margin) {
  return {box.low.array() - margin, box.high.array() + margin};
}

inline Box box_around_both(const Box& one, const Box& other) {
  return {one.low.cwiseMin(other.low), one.high.cwiseMax(other.high)};
}

inline bool is_within(const Point& x, const Box& box) {
  return (x.array() >= box.low.array()).all() && (x.array() <= box.high.array()).all();
}

/// The number of pairs of boxes that have a coordinate (0 or 1) in common, and those that nearly do: boxes
/// begin and end in one of so many slices.
inline std::size_t pairs_sharing(const std::vector<Box>& boxes, int coordinate) {
  constexpr int slices = 4096;
  double lowest = boxes[0].low[coordinate], highest = boxes[0].high[coordinate];
  for (const Box& box : boxes) {
    lowest = std::min(lowest, box.low[coordinate]);
    highest = std::max(highest, box.high[coordinate]);
  }
  // Not a number where the boxes are wider than numbers go.
  const auto slice_of = [&](double x) {
    const double share = (x - lowest) / (highest - lowest);
    return share > 0 ? static_cast<int>(std::min(share, 1.) * (slices - 1)) : 0;
  };
  std::array<std::size_t, slices> begun{}, ended{};
  for (const Box& box : boxes) {
    ++begun[slice_of(box.low[coordinate])];
    ++ended[slice_of(box.high[coordinate])];
  }
  std::size_t apart = 0, before = 0;
  for (int slice = 0; slice < slices; ++slice) {
    apart += begun[slice] * before;
    before += ended[slice];
  }
  return boxes.size() * (boxes.size() - 1) / 2 - apart;
}

/// Calls visit(i, j) for every pair of boxes that meet, until it returns false.
///
/// A sweep along x, or along y where far fewer pairs share a y: quadratic only where most share both.
template <typename Visit>
void for_each_meeting_pair(const std::vector<Box>& boxes, Visit visit) {
  if (boxes.empty()) return;
  const int along = pairs_sharing(boxes, 0) > 8 * pairs_sharing(boxes, 1) ? 1 : 0, across = 1 - along;
  std::vector<int> by_begin(boxes.size());
  std::iota(by_begin.begin(), by_begin.end(), 0);
  std::ranges::sort(by_begin, {}, [&](int i) { return std::pair(boxes[i].low[along], i); });
  std::vector<Box> sorted;  // for they are looked at one after the other
  for (const int i : by_begin) sorted.push_back(boxes[i]);
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const Box& box = sorted[k];
    for (std::size_t l = k + 1; l < sorted.size(); ++l) {
      const Box& other = sorted[l];
      if (other.low[along] > box.high[along]) break;
      const bool meet = other.low[across] <= box.high[across] && box.low[across] <= other.high[across];
      if (meet && !visit(by_begin[k], by_begin[l])) return;
    }
  }
}

}  // namespace signorini
