#include "contact/rigid_motions.hpp"
#include "requested_mesh.hpp"
#include "solve.hpp"

namespace signorini {

void require_rest(const Problem& problem) {
  // Up to here it takes a second at most; beyond, the solve itself will tell within its first ones.
  constexpr std::int64_t moderate = 400'000;
  Problem start = problem;
  start.mesh.adaptive.reset();
  const std::int64_t triangles = estimate(start).triangles;
  if (problem.mesh.adaptive) require_room(*problem.mesh.adaptive, triangles);
  if (triangles > moderate) return;
  const Mesh mesh = stabilized(problem, make_domain_mesh(problem.domain, problem.mesh));
  held_by_contact_alone(Discretization(problem, mesh));
}

}  // namespace signorini
