#include "mesh/triangles_at_points.hpp"

#include <numeric>
#include <ranges>

namespace signorini {

TrianglesAtPoints::TrianglesAtPoints(const Mesh& mesh)
    : first_(mesh.points.size() + 1), triangles_(3 * mesh.triangles.size()) {
  for (const auto& points : mesh.triangles)
    for (const int point : points) ++first_[point];
  // From here on where those of each point end, and when all are there, where they begin.
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  for (int t = static_cast<int>(mesh.triangles.size()) - 1; t >= 0; --t)
    for (const int point : mesh.triangles[t]) triangles_[--first_[point]] = t;
}

}  // namespace signorini
