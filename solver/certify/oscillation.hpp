#pragma once

#include "certify/load_values.hpp"
#include "certify/tensor.hpp"
#include "fem/traction_field.hpp"

namespace signorini {

/// What the discrete equilibrium leaves out of the load, in the energy norm: a bound of
///
///     (f − Πf, w) + <t − Πt, w>  ≤  oscillation · ‖w‖_E
///
/// on one triangle, for every displacement w, with the projections Π onto P2, so that w counts only up to
/// linear functions at least: linear_remainder().
template <int D>
class Oscillation {
 public:
  explicit Oscillation(const Discretization& problem)
      : problem_(problem), traction_(problem.problem, problem.mesh) {}

  double operator()(int t, LawField<D>& law, const LoadValues<D>& load) const;

 private:
  double of_traction(int edge) const;

  const Discretization& problem_;
  TractionField traction_;
};

}  // namespace signorini
