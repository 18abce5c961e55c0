#pragma once

#include <span>
#include <vector>

#include "mesh/mesh.hpp"

namespace signorini {

/// The triangles at every point of a mesh, by their numbers in ascending order.
class TrianglesAtPoints {
 public:
  explicit TrianglesAtPoints(const Mesh& mesh);

  std::span<const int> operator[](int point) const {
    return {triangles_.data() + first_[point], triangles_.data() + first_[point + 1]};
  }

 private:
  std::vector<int> first_;      ///< of each point, in triangles_
  std::vector<int> triangles_;  ///< those of all points, one after the other
};

}  // namespace signorini
