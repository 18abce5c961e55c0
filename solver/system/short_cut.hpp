#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "system/element_tree.hpp"

namespace signorini {

/// Where an element of a sum lies. The axes are tilted by so little that those of a column or row of squares
/// come one after the other, and no two at once.
struct Centre {
  std::array<double, 2> at;
  int element;
};

std::vector<Centre> tilted(const std::vector<Point>& centres);

/// Cuts pieces of a mesh in two, across x or y, so that the halves share few numbers: of edges, or of
/// unknowns where there are none.
///
/// That is in the widest gap near the median of the longer extent, between squares if there are any, where it
/// is as short as a cut between squares would be. Arms and long triangles make it longer: then it is the cut
/// with the least ratio of what the halves a, b share to |a| |b| (the ratio cut of Wei and Cheng 1989), of
/// all those across x and y that leave neither half less than some third; of those with nearly that ratio,
/// the one in the widest gap. Leaves have from half to twice the elements that they would have if all had as
/// many, or nearly.
class ShortCut {
 public:
  /// Fewer elements are cut near the median: what is looked for elsewhere costs more than it saves.
  static constexpr std::size_t kFew = 128;

  ShortCut(const SharedNumbers& numbers, int elements, int leaves);

  /// Sorts the elements of a piece, which is to have so many leaves, so that those of a half are neighbours,
  /// and says how many the first half has.
  std::size_t operator()(std::span<Centre> piece, int leaves);

 private:
  struct Cut {
    int along;
    std::size_t first_half;
    double ratio;
  };

  /// Of coordinates.
  struct Range {
    double low, extent;
  };

  std::size_t divide_between_columns(std::span<Centre> piece, int along, const Eigen::AlignedBox2d& box);
  void find_between(std::span<const Centre> piece, std::size_t first, std::size_t last, int along,
                    const Range& range);
  void divide_before(std::span<Centre> piece, double coordinate, int along);
  int shared(std::span<const Centre> piece, std::size_t first_half);
  Cut shortest(std::span<Centre> piece, std::size_t least_half, int along);

  const SharedNumbers numbers_;
  const double elements_per_leaf_;
  const double per_side_;  ///< numbers of a side: a third of a triangle's
  int seen_ = 0;
  std::vector<int> seen_as_;       ///< of each number: what it was last seen as,
  std::vector<int> first_, last_;  ///< and the places of its elements in the piece that was last looked at
  std::vector<double> between_;    ///< the coordinates near the median of that piece
  std::vector<Centre> second_half_;
};

}  // namespace signorini
