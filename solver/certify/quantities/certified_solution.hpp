#pragma once

#include "certify/admissible_pair.hpp"
#include "certify/data/carried_loads.hpp"

namespace signorini {

/// A discrete solution with its admissible pair, and with what is known of the stress that makes up for what
/// σ* does not balance (THEORY.md, section 3).
struct CertifiedSolution {
  /// Of a mesh without patches. Discretization and solution must outlive it. `of_load`: load_remainders() of
  /// all triangles. `base`: of a dual problem, in
  /// which the pressure of the base takes what is not balanced where nothing is fixed.
  CertifiedSolution(const Discretization& discrete, const Solution& solution, AdmissiblePair admissible,
                    const Eigen::VectorXd& of_load, const LawOnMesh& laws, Progress& progress,
                    const CertifiedSolution* base = nullptr);

  /// A bound of the part of that stress that is not on single triangles.
  double carried() const { return loads.norm; }
  /// A bound of all of it.
  double unbalanced() const { return oscillations.norm() + carried(); }

  const Discretization& discrete;
  const Eigen::MatrixXd& stress;  ///< σ_h
  AdmissiblePair pair;
  Eigen::VectorXd oscillations;  ///< o_T, an entry a triangle
  CarriedLoads loads;
  std::vector<std::string> unmet;
};

}  // namespace signorini
