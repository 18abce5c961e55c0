#pragma once

#include <memory>

#include "mesh/domain_mesh.hpp"
#include "mesh/stability.hpp"
#include "problem/problem.hpp"
#include "progress.hpp"
#include "system/cholesky.hpp"

namespace signorini {

/// The mesh that the problem asks for.
inline std::shared_ptr<const Mesh> requested_mesh(const Problem& problem, Progress& progress) {
  progress.enter(Phase::mesh);
  return std::make_shared<const Mesh>(make_domain_mesh(problem.domain, problem.mesh));
}

/// What `solve` answers for the mesh; where the pair of spaces for elasticity is not stable on a
/// coarse mesh, because too few free edges control the rotation of its corners, for a mended one.
template <typename Solve>
auto on_stable_mesh(const Problem& problem, std::shared_ptr<const Mesh> mesh, const Solve& solve) {
  constexpr std::size_t coarse = 200;
  for (int attempt = 0;; ++attempt) {
    try {
      return solve(mesh);
    } catch (const NotPositiveDefinite&) {
      const bool can_be_mended = components(problem.material) == 2 && mesh->triangles.size() < coarse;
      if (!can_be_mended || attempt == 2) throw;
      mesh = std::make_shared<const Mesh>(mend(*mesh));
    }
  }
}

}  // namespace signorini
