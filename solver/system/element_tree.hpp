#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "problem/field.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// What elements share, by its numbers below `size`: so many an element, -1 for none.
struct SharedNumbers {
  std::span<const int> of(int element) const {
    return all.subspan(static_cast<std::size_t>(element) * per_element, per_element);
  }

  std::span<const int> all;
  int per_element, size;
};

/// The elements of a mesh, cut into two halves that share few numbers (system/short_cut.hpp), and the halves
/// again, until a piece has a few.
///
/// The pieces are a complete binary tree, numbered as in a heap: 1 is the whole, 2 k and 2 k + 1 are the
/// halves of k. It depends on where the elements lie and on what they share: other unknowns on the same mesh
/// may be dissected by the same tree.
class ElementTree {
 public:
  /// By the places of the elements, one at least. Throws what Progress throws.
  ElementTree(const std::vector<Point>& centres, const SharedNumbers& shared, Progress& progress);

  int leaves() const { return leaves_; }
  int pieces() const { return 2 * leaves_; }  ///< one more than the largest number
  bool is_leaf(int piece) const { return piece >= leaves_; }
  /// The elements of a leaf, in rows along x from below.
  std::span<const int> elements(int leaf) const {
    const std::size_t first = first_element_[leaf - leaves_];
    return std::span(elements_).subspan(first, first_element_[leaf - leaves_ + 1] - first);
  }

  /// The memory that it takes.
  std::size_t bytes() const {
    return elements_.capacity() * sizeof(int) + first_element_.capacity() * sizeof(std::size_t);
  }

 private:
  int leaves_;
  std::vector<int> elements_;               ///< leaf by leaf
  std::vector<std::size_t> first_element_;  ///< of each leaf, and behind the last
};

/// Of triangles, by the numbers of their edges: whatever the unknowns on a mesh, their halves share few.
std::shared_ptr<const ElementTree> tree_by_edges(const std::vector<Point>& centres,
                                                 std::span<const std::array<int, 3>> edges_of_triangles,
                                                 Progress& progress);

}  // namespace signorini
