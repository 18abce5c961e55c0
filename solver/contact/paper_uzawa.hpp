#pragma once

#include <memory>

#include "fem/discretization.hpp"
#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"
#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// The paper's Uzawa iteration (section 5; solver/README.md has its misprints) to the letter: σ^m solves the
/// augmented first equation for u^m and λ^m; then
///
///     u^{m+1} = u^m + ρ Π_V (div σ^m + f),    λ^{m+1} = max(0, λ^m + ρ σ_n^m),
///
/// with the clip at the nodes in the lumped inner product; it stops by the paper's criterion. The matrix
/// K_r in the free traces is factored once; one iteration is one solve with it.
class UzawaIteration {
 public:
  /// Eliminates and factors. Throws Cancelled and what factorize() throws.
  UzawaIteration(const Discretization& discrete, const PaperUzawa& settings, Factorization by,
                 Progress& progress);

  /// Iterates until the criterion is met, the iterates grow beyond bounds, or a limit is reached. What
  /// remains is the last finite iterate.
  Outcome run(Progress& progress);

  Eigen::MatrixXd stress() const;                                        ///< σ^m, a column a triangle
  const Eigen::MatrixXd& displacement() const { return displacement_; }  ///< u^{m+1}, a column a triangle
  const Eigen::VectorXd& clearance() const { return clearance_; }        ///< λ^{m+1}, the contact unknowns
  const Eigen::VectorXd& coupling() const { return x_; }                 ///< traces and rotations of σ^m

 private:
  void eliminate(Factorization by, Progress& progress);
  void add_free(ElementSum& matrix, int triangle, const LocalMatrix& stiffness) const;
  void start();
  void augment(const Eigen::MatrixXd& displacement);
  void solve_first_equation(Progress& progress);
  void update_displacement();
  void update_clearance();
  Iteration record();
  void update_pressure();
  LocalVector flux_on_contact(int triangle) const;
  bool is_free(int triangle) const;
  Eigen::Map<const Eigen::MatrixXd> stiffness(int triangle) const;

  const Discretization& discrete_;
  const PaperUzawa settings_;

  std::unique_ptr<const Factor> factor_;
  Factor::Workspace workspace_;
  std::vector<double> stiffness_;          ///< K_r of the triangles on Γ_D or Γ_C only, one after the other
  std::vector<int> stiffness_of_;          ///< its number for each triangle, or -1
  Eigen::MatrixXd coupling_, divergence_;  ///< P and D, a column a triangle
  Eigen::MatrixXd load_;                   ///< Π_V f, a column a triangle
  LocalMatrix mass_inverse_;               ///< (v_i, v_j)⁻¹ times det J
  Eigen::VectorXd determinant_;            ///< det J of each triangle
  Eigen::VectorXd weight_;                 ///< <1, φ_i> of the contact unknowns

  Eigen::VectorXd x_;      ///< traces of σ^m, and λ^m behind them
  Eigen::VectorXd given_;  ///< the same with traces of 0, for the next one
  Eigen::VectorXd right_;
  Eigen::MatrixXd displacement_, last_displacement_;
  Eigen::MatrixXd augmented_;  ///< u^m + r Π_V f
  Eigen::VectorXd clearance_, last_clearance_;
  Eigen::MatrixXd imbalance_;  ///< Π_V (div σ^m + f), a column a triangle
  Eigen::VectorXd forces_;     ///< <−σ_n^m, φ_i> of all rows of the clearance space
  Eigen::VectorXd pressure_;   ///< −σ_n^m of the contact unknowns
  double first_imbalance_ = 0, largest_pressure_ = 0;
};

}  // namespace signorini
