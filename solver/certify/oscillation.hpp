#pragma once

#include "certify/tensor.hpp"
#include "fem/discretization.hpp"
#include "fem/traction_field.hpp"

namespace signorini {

/// Column z: Πf at corner z of a triangle, the load that σ* is in equilibrium with: the projection onto P_k
/// for a membrane, onto P1 for an elastic body, of which σ_h is in equilibrium with the force and the moment
/// at least.
template <int D>
Eigen::Matrix<double, D, 3> discrete_load(const Discretization& problem, int t);

/// What the discrete equilibrium leaves out of the load, in the energy norm: a bound of
///
///     (f − Πf, w) + <t − Πt, w>  ≤  oscillation · ‖w‖_E
///
/// on one triangle, for every displacement w. Π keeps what a rigid motion of the triangle sees, so that w
/// counts only up to one: rigid_remainder() for an elastic body. For a membrane it is the inequality of Payne
/// and Weinberger, ‖w − w̄‖ ≤ h/π ‖∇w‖, and the trace inequality that follows from it, ‖w − w̄‖²_e ≤
/// |e|/|T| h² (1/π² + 1/π) ‖∇w‖².
template <int D>
class Oscillation {
 public:
  explicit Oscillation(const Discretization& problem)
      : problem_(problem), traction_(problem.problem, problem.mesh) {}

  double operator()(int t, LawField<D>& law) const;

 private:
  double of_load(int t) const;
  double of_traction(int edge) const;

  const Discretization& problem_;
  TractionField traction_;
};

}  // namespace signorini
