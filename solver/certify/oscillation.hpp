#pragma once

#include "certify/load_values.hpp"
#include "certify/tensor.hpp"
#include "fem/traction_field.hpp"

namespace signorini {

/// What the discrete equilibrium leaves out of the load, in the energy norm: a bound of
///
///     (f − Πf, w) + <t − Πt, w>  ≤  oscillation · ‖w‖_E
///
/// on one triangle, for every displacement w, with the projections Π onto P1. They keep what a rigid motion
/// of the triangle sees, so that w counts only up to one: rigid_remainder() for an elastic body. For a
/// membrane it is Poincaré's inequality with the best constant for triangles, ‖w − w̄‖ ≤ h/j ‖∇w‖ (Laugesen,
/// Siudeja 2010), and the trace inequality that follows from it, ‖w − w̄‖²_e ≤ |e|/|T| h² (1/j² + 1/j) ‖∇w‖².
template <int D>
class Oscillation {
 public:
  explicit Oscillation(const Discretization& problem)
      : problem_(problem), traction_(problem.problem, problem.mesh) {}

  double operator()(int t, LawField<D>& law, LoadValues<D>& load) const;

 private:
  double of_load(int t, LoadValues<D>& load) const;
  double of_traction(int edge) const;

  const Discretization& problem_;
  TractionField traction_;
};

}  // namespace signorini
