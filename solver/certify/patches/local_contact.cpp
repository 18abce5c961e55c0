#include "certify/patches/local_contact.hpp"

#include "contact/active_set.hpp"
#include "contact/complete.hpp"
#include "contact/rigid_motions.hpp"
#include "mesh/submesh.hpp"
#include "system/hybrid_system.hpp"

namespace signorini {
namespace {

Problem with_cut(const Problem& whole, const Condition& on_cut) {
  Problem problem;
  problem.material = whole.material;
  problem.body = whole.body;
  problem.boundary = whole.boundary;
  problem.boundary[Submesh::kCut] = on_cut;
  problem.scheme = whole.scheme;
  return problem;
}

}  // namespace

LocalContact::LocalContact(const Discretization& whole, const Patch& patch, const Condition& on_cut,
                           Progress& progress)
    : problem_(with_cut(whole.problem, on_cut)), discretization_(problem_, *patch.mesh, &progress) {
  discretization_.draw_near(whole.clearance.reach);
  const bool held = held_by_contact_alone(discretization_);
  const HybridSystem system = assemble(discretization_, progress);
  const Operator made(patch.mesh, discretization_.clearance, system.matrix, held, Factorization::multifrontal,
                      progress);
  CondensedContact condensed(made, system.right, progress);
  Eigen::VectorXd found;
  if (discretization_.clearance.unknowns > 0) found = active_set(condensed.contact(), {}, progress).clearance;
  Completed all = complete(discretization_, condensed, found, open_unknowns(found), progress);
  is_balanced_ = all.fields.is_balanced(discretization_.traces);
  solution_.stress = std::move(all.fields.stress);
  solution_.displacement = std::move(all.fields.displacement);
  coupling_ = std::move(all.coupling);
  if (discretization_.clearance.is_touched_too_early(found))
    throw SolveError("the patch meets the foundation where the whole does not");
  clearance_ = discretization_.clearance.clearance(found);
}

}  // namespace signorini
