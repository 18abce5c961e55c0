#pragma once

#include <algorithm>
#include <cmath>

#include "certify/quantities/certified_solution.hpp"
#include "contact/dual_contact.hpp"
#include "run/condensed_problem.hpp"

namespace signorini {

/// dual_problem() on the mesh of a problem, condensed by its operator: the same for all loads and gaps.
class CondensedDual {
 public:
  CondensedDual(const CondensedDual&) = delete;
  CondensedDual(const CondensedProblem& base, const Quantity& quantity, Progress& progress);

 private:
  friend class DualSolution;

  /// With contact closed where it was, its solution is the same for many entries of a sweep.
  struct Solved {
    Eigen::VectorXd clearance;
    std::vector<int> open;
    Eigen::VectorXd coupling;
    Solution solution;  ///< its residuals when it is certified
    bool has_residuals = false;
  };

  Solved& solved(const DualContact& contact, Progress& progress);
  void find_residuals(Solved& solved, Progress& progress) const;

  const std::shared_ptr<const Operator> operator_;  ///< has the mesh
  Problem problem_;
  Discretization discretization_;
  const Eigen::VectorXd right_;
  CondensedContact condensed_;
  const Eigen::VectorXd remainders_;                 ///< load_remainders()
  const std::optional<QuadraticValues> of_balance_;  ///< stream_function_of_balance()
  const bool has_loads_;
  std::optional<Solved> last_;
};

/// What the solution of a problem changes by along its data: its dual problem, solved with contact closed
/// where it was.
class DualSolution {
 public:
  DualSolution(const DualSolution&) = delete;
  /// Both must outlive it.
  DualSolution(const CondensedProblem& base, CondensedDual& dual) : base_(base), dual_(dual) {}

  const Discretization& discretization() const { return dual_.discretization_; }

  /// Solves it. `clearance`: of the base. Forces of contact are held at `factor` times those of the base.
  void solve(const Eigen::VectorXd& clearance, double factor, Progress& progress);

  /// Another solve with this factor would hold other forces.
  bool is_beyond(double factor) const {
    return factor != factor_ && (largest_factor_ > factor || std::isfinite(factor_));
  }

  const Eigen::MatrixXd& stress() const { return solved_->solution.stress; }
  /// max |η| in the body, and of the clearances.
  double largest_displacement() const {
    return std::max(solved_->solution.displacement.lpNorm<Eigen::Infinity>(),
                    solved_->clearance.lpNorm<Eigen::Infinity>());
  }

  /// With the pair beside that of the base: `factor` is that of dual_pair(). Refers to this.
  CertifiedSolution certified(const CertifiedSolution& base, double factor, const LawOnMesh& laws,
                              Progress& progress) const;

 private:
  const CondensedProblem& base_;
  CondensedDual& dual_;
  double factor_ = 0, largest_factor_ = 0;
  CondensedDual::Solved* solved_ = nullptr;
};

}  // namespace signorini
