#pragma once

#include <vector>

#include <Eigen/Core>

#include "mesh/mesh.hpp"

namespace signorini {

/// The stresses of compliance 1 on a mesh that have a linear load on each triangle, linear tractions on the
/// edges between them and on the loaded edges, and no traction on the rest of the boundary: those of RT1 for
/// a membrane, and of the macro-elements (johnson_mercier.hpp) for an elastic body. The unknowns are the
/// tractions at both ends of the loaded edges, then those of the edges inside, then what the triangles have
/// more.
template <int D>
struct LocalEquilibrium {
  explicit LocalEquilibrium(const Mesh& mesh, const std::vector<int>& loaded = {});

  Eigen::MatrixXd energy;  ///< ‖τ‖² of the stress with the unknowns z is zᵀ energy z
  Eigen::MatrixXd
      loads;  ///< −div τ at the three corners of each triangle, the components of a corner together
  Eigen::MatrixXd mass;    ///< (r, s) of two such loads
  Eigen::MatrixXd linear;  ///< the loads that are linear on the whole mesh
};

}  // namespace signorini
