#pragma once

#include <cstdint>
#include <memory>

#include "fem/stability.hpp"
#include "mesh/domain_mesh.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Throws InvalidProblem if a mesh that refines itself has too many triangles to start from.
inline void require_room(const Adaptive& goal, std::int64_t triangles) {
  if (triangles > goal.max_triangles)
    throw InvalidProblem(
        {{"/mesh/adaptive/max_triangles", "the mesh to start from has " + std::to_string(triangles) +
                                              " triangles already: raise it, or start from a coarser mesh"}});
}

/// The mesh that the problem asks for, refined where the spaces are not stable on it.
inline std::shared_ptr<const Mesh> requested_mesh(const Problem& problem, Progress& progress) {
  progress.enter(Phase::mesh);
  return std::make_shared<const Mesh>(
      stabilized(problem, make_domain_mesh(problem.domain, problem.mesh, &progress), &progress));
}

}  // namespace signorini
