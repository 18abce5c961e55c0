#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "mesh/mesh.hpp"
#include "problem/domain.hpp"

namespace signorini {

/// How many of everything a mesh has.
struct MeshSizes {
  /// The edges of one part of the boundary, and how many of them are chords of arcs.
  struct Part {
    std::int64_t edges = 0, chords = 0;
  };

  std::int64_t triangles = 0, edges = 0, points = 0;
  std::vector<Part> parts;  ///< in the order of part_names()
  double across = 0;  ///< the share of triangles that reach across the domain, of a mesh that is not there

  /// Of all parts: of a mesh that is given, of its boundary.
  std::int64_t edges_of_parts() const;
};

MeshSizes sizes_of(const Mesh& mesh);

/// The sizes of the meshes that make_domain_mesh() makes of a domain without a fault, from lengths and areas,
/// without their uniform refinements: exact but for a polygon, where they are rather too large than too
/// small, if not between long sides of unlike lengths very close together. What does not depend on the mesh
/// is worked out once. The domain must outlive it.
class PredictedSizes {
 public:
  explicit PredictedSizes(const Domain& domain);
  ~PredictedSizes();

  MeshSizes operator()(const MeshRequest& request) const;

 private:
  class OfPolygon;

  const Domain& domain_;
  std::unique_ptr<const OfPolygon> polygon_;
};

/// After so many uniform refinements, exactly.
MeshSizes refined(MeshSizes sizes, int times);

}  // namespace signorini
