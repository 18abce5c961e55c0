#pragma once

#include "certify/quantities/certified_solution.hpp"
#include "run/condensed_problem.hpp"

namespace signorini {

/// What the solution of a problem changes by along its data: dual_problem() on its mesh, solved by its
/// operator, with contact closed where it was.
class DualSolution {
 public:
  DualSolution(const DualSolution&) = delete;
  /// All must outlive it.
  DualSolution(const CondensedProblem& base, const Quantity& quantity, Progress& progress);

  const Discretization& discretization() const { return discretization_; }

  /// Solves it. `clearance`: of the base. Forces of contact are held at `factor` times those of the base.
  void solve(const Eigen::VectorXd& clearance, double factor, Progress& progress);

  /// What the forces of contact that are not held are of those of the base at most.
  double largest_factor() const { return largest_factor_; }
  const Eigen::MatrixXd& stress() const { return solution_.stress; }
  const Eigen::MatrixXd& displacement() const { return solution_.displacement; }

  /// With the pair beside that of the base: `factor` is that of dual_pair(). Refers to this.
  CertifiedSolution certified(const CertifiedSolution& base, double factor, const LawOnMesh& laws,
                              Progress& progress) const;

 private:
  const CondensedProblem& base_;
  Problem problem_;
  Discretization discretization_;
  CondensedContact condensed_;
  double largest_factor_ = 0;
  Eigen::VectorXd coupling_;
  Solution solution_;
};

}  // namespace signorini
