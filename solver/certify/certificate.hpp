#pragma once

#include <memory>
#include <optional>
#include <string>

#include "certify/admissible_pair.hpp"
#include "certify/pair_sums.hpp"
#include "fem/discretization.hpp"
#include "progress/progress.hpp"
#include "result/in_range.hpp"

namespace signorini {

class ShapeNorms;

/// The error bound with its share in every triangle.
struct Certificate {
  ErrorBound bound;  ///< not finite if there is none
  /// Entry t: the square of the energy norm that triangle t adds to the bound: the guide for refinement.
  Eigen::VectorXd squares;
  /// Solution::admissible_pressure.
  std::vector<EdgePressure> pressure;
  /// v and σ* without patches, where the problem asks for quantities; refers to the discretization.
  std::unique_ptr<AdmissiblePair> pair;
  std::optional<PairSums> sums;              ///< of that pair
  std::vector<EnclosedQuantity> quantities;  ///< that the problem asks for, if there is a bound
  std::string late;                          ///< what the time limit left out, in words

  bool has_bound() const { return is_in_range(bound); }
};

/// Bounds the error of a discrete solution by an admissible displacement v and a stress σ* in equilibrium
/// with Πf and Πt whose pressure p* on Γ_C is nowhere negative: see THEORY.md and bound_from(). Data that
/// turn out to be unsound in a point that the discrete problem does not ask leave it without a bound.
///
/// `coupling`: the unknowns of the trace space. `norms`: those of the law, for others too.
Certificate certify(const Discretization& discrete, const Solution& solution, const Eigen::VectorXd& coupling,
                    ShapeNorms& norms, Progress& progress);

/// Makes the bound of a solution one of another stress τ of the same spaces, such as an iterate:
/// ‖σ − τ‖_C ≤ ‖σ − σ_h‖_C + ‖σ_h − τ‖_C. The energies stay, those of the pair (σ*, v).
void move_to(const Eigen::MatrixXd& stress, const Discretization& discrete, const Solution& solution,
             Certificate& certificate, Progress& progress);

}  // namespace signorini
