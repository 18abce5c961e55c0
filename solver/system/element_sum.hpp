#pragma once

#include <memory>
#include <span>
#include <vector>

#include "problem/field.hpp"
#include "system/element_tree.hpp"

namespace signorini {

/// A sparse symmetric matrix as the sum of small dense ones, one an element. Elements of the same shape
/// share theirs.
struct ElementSum {
  int size = 0;         ///< unknowns of the whole matrix
  int per_element = 0;  ///< rows of a small matrix

  std::vector<int> unknowns;   ///< of each row of each element in turn; -1 leaves the row out
  std::vector<int> matrix_of;  ///< the number of each element's matrix
  /// The matrices, per_element² numbers each. They are not moved when more of them come, which would take
  /// twice the memory.
  std::vector<std::vector<double>> blocks;
  std::vector<Point> centres;  ///< where the elements lie
  /// How they are cut into pieces, if that is known: by their edges, or as another sum on the mesh was.
  std::shared_ptr<const ElementTree> tree;

  int elements() const { return static_cast<int>(matrix_of.size()); }
  std::span<const int> unknowns_of(int element) const {
    return std::span(unknowns).subspan(static_cast<std::size_t>(element) * per_element, per_element);
  }
  const double* matrix(int element) const { return kept(matrix_of[element]); }

  /// Takes a matrix and answers its number.
  int keep(const double* values);
  /// That of one of the last few among `known` that is equal but for rounding, or takes it and adds its
  /// number to them.
  int keep(const double* values, std::vector<int>& known);

  /// That of the whole matrix.
  std::vector<double> diagonal() const;

 private:
  static constexpr int kPerBlock = 64;
  std::size_t numbers() const { return static_cast<std::size_t>(per_element) * per_element; }
  const double* kept(int matrix) const {
    return blocks[matrix / kPerBlock].data() + matrix % kPerBlock * numbers();
  }
};

}  // namespace signorini
