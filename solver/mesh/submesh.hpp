#pragma once

#include "mesh/mesh.hpp"

namespace signorini {

/// Some triangles of a mesh as a mesh of their own.
struct Submesh {
  /// The name of the part that the edges between its triangles and the others form: none that a client can
  /// give.
  static constexpr const char* kCut = "";

  /// Triangle i is `triangles[i]` of the whole.
  Submesh(const Mesh& whole, const std::vector<int>& triangles);

  Mesh mesh;
  std::vector<int> cut;  ///< the edges of the part kCut, by their numbers in the whole mesh
};

}  // namespace signorini
