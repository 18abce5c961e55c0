#include "system/elimination.hpp"

namespace signorini {
namespace {

/// G = [E; −A].
LocalMatrix coupling_of(const ElementMatrices& element, const Spaces& spaces) {
  const int traces = 3 * spaces.traces_per_edge();
  LocalMatrix coupling = LocalMatrix::Identity(traces + spaces.rotations(), spaces.stresses());
  coupling.bottomRows(spaces.rotations()) = -element.skew;
  return coupling;
}

/// The translation that has the mean of the traces, in the coefficients of the displacement; and its traces.
struct Translation {
  Translation(const LocalVector& coupling, const Spaces& spaces)
      : displacement(spaces.displacements()), traces(LocalVector::Zero(coupling.size())) {
    const int d = spaces.components, count = 3 * spaces.traces_per_edge();
    for (int c = 0; c < d; ++c) {
      double mean = 0;
      for (int j = c; j < count; j += d) mean += coupling[j] * d / count;
      for (int j = c; j < count; j += d) traces[j] = mean;
      for (int j = c; j < displacement.size(); j += d) displacement[j] = mean;
    }
  }

  LocalVector displacement, traces;
};

}  // namespace

SmallCholesky::SmallCholesky(const LocalMatrix& matrix)
    : whole_(matrix), inverse_pivots_(whole_.matrixLLT().diagonal().cwiseInverse()) {}

LocalVector SmallCholesky::solve(LocalVector b) const {
  const LocalMatrix& l = whole_.matrixLLT();
  const Eigen::Index n = b.size();
  for (Eigen::Index j = 0; j < n; ++j) {
    b[j] *= inverse_pivots_[j];
    for (Eigen::Index i = j + 1; i < n; ++i) b[i] -= l(i, j) * b[j];
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    for (Eigen::Index i = j + 1; i < n; ++i) b[j] -= l(i, j) * b[i];
    b[j] *= inverse_pivots_[j];
  }
  return b;
}

Elimination::Elimination(const ElementMatrices& element, const Spaces& spaces)
    : spaces_(spaces),
      coupling_(coupling_of(element, spaces)),
      compliance_(element.compliance),
      lifted_(compliance_.whole().solve(spaces.divergence.transpose())),
      displacement_(LocalMatrix(spaces.divergence * lifted_)) {}

LocalMatrix Elimination::stiffness() const {
  const LocalMatrix fluxes = coupling_ * lifted_;
  const LocalMatrix flexible =
      coupling_ * LocalMatrix(compliance_.whole().solve(LocalMatrix(coupling_.transpose())));
  return flexible - fluxes * LocalMatrix(displacement_.whole().solve(LocalMatrix(fluxes.transpose())));
}

LocalMatrix Elimination::coupling_load() const {
  const LocalMatrix fluxes = coupling_ * lifted_;
  return displacement_.whole().solve(LocalMatrix(fluxes.transpose())).transpose();
}

/// M σ + Bᵀ u = a, B σ = b.
LocalFields Elimination::solve(const LocalVector& a, const LocalVector& b) const {
  LocalFields fields;
  fields.displacement = displacement_.solve(lifted_.transpose().lazyProduct(a) - b);
  fields.stress = compliance_.solve(a) - lifted_.lazyProduct(fields.displacement);
  return fields;
}

LocalFields Elimination::recover(const LocalVector& coupling, const LocalVector& load,
                                 const StrainMoments& strain) const {
  // A translation has no stress. Without it the traces are as small as their differences, and the stress
  // keeps its digits on small triangles.
  const Translation translation(coupling, spaces_);
  const LocalVector right = coupling_.transpose().lazyProduct(coupling - translation.traces);
  LocalFields fields = solve(right, -load);
  // Near incompressibility W is badly conditioned; one correction brings the balance back to rounding and
  // the volume's strain to its digits.
  const LocalFields correction =
      solve(right - strain(fields.stress) - spaces_.divergence.transpose().lazyProduct(fields.displacement),
            -load - spaces_.divergence.lazyProduct(fields.stress));
  fields.stress += correction.stress;
  fields.displacement += correction.displacement;
  fields.displacement += translation.displacement;
  fields.force = force(fields.stress);
  return fields;
}

LocalFields Elimination::respond(const LocalVector& coupling_change, const LocalVector& lack) const {
  LocalFields fields = solve(coupling_.transpose().lazyProduct(coupling_change), lack);
  fields.force = force(fields.stress);
  return fields;
}

AugmentedElimination::AugmentedElimination(const ElementMatrices& element, const Spaces& spaces,
                                           double augmentation)
    : b_(spaces.divergence),
      coupling_(coupling_of(element, spaces)),
      compliance_(element.compliance +
                  augmentation * b_.transpose() * LocalMatrix(element.displacement_mass.llt().solve(b_))),
      lifted_(compliance_.whole().solve(b_.transpose())) {}

LocalMatrix AugmentedElimination::stiffness() const {
  return coupling_ * LocalMatrix(compliance_.whole().solve(LocalMatrix(coupling_.transpose())));
}

LocalMatrix AugmentedElimination::coupling() const {
  return coupling_ * lifted_;
}

LocalMatrix AugmentedElimination::divergence() const {
  return b_ * lifted_;
}

LocalVector AugmentedElimination::stress(const LocalVector& coupling, const LocalVector& w) const {
  return compliance_.solve(coupling_.transpose().lazyProduct(coupling)) - lifted_.lazyProduct(w);
}

}  // namespace signorini
