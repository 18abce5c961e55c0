#include "mesh/upright.hpp"

#include "mesh/segments.hpp"

namespace signorini {

void require_upright(const Mesh& mesh) {
  if (mesh.circles.empty()) return;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    if (!(twice_area(a, b, c) > 0))
      throw InvalidProblem(
          {{"/mesh/size", "is too large for the arcs near " + to_string(a) +
                              ": their points would turn a triangle over when the mesh is refined; "
                              "give a smaller size"}});
  }
}

}  // namespace signorini
