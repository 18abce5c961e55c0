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

Elimination::Elimination(const ElementMatrices& element, const Spaces& spaces)
    : spaces_(spaces), coupling_(coupling_of(element, spaces)) {
  const LocalMatrix &z = spaces.solenoidal, &m = element.compliance;
  const LocalMatrix m_z = m * z, form = z.transpose() * m_z;
  const LocalMatrix lifting = spaces.lifting.transpose(), lifted = lifting * m;
  root_ = z.transpose();
  Eigen::LLT<LocalMatrix>(form).matrixL().solveInPlace(root_);
  p_ = root_.transpose() * root_;
  q_ = lifting - lifted * p_;
  w_inverse_ = lifted * q_.transpose();
}

LocalMatrix Elimination::stiffness() const {
  const LocalMatrix root = root_ * coupling_.transpose();
  return root.transpose() * root;
}

LocalMatrix Elimination::coupling_load() const {
  return coupling_ * q_.transpose();
}

/// M σ + Bᵀ u = a, B σ = b.
LocalFields Elimination::solve(const LocalVector& a, const LocalVector& b) const {
  LocalFields fields;
  fields.stress = p_.lazyProduct(a) + q_.transpose().lazyProduct(b);
  fields.displacement = q_.lazyProduct(a) - w_inverse_.lazyProduct(b);
  return fields;
}

LocalFields Elimination::recover(const LocalVector& coupling, const LocalVector& load,
                                 const StrainMoments& strain) const {
  // A translation has no stress. Without it the traces are as small as their differences, and the stress
  // keeps its digits on small triangles.
  const Translation translation(coupling, spaces_);
  const LocalVector right = coupling_.transpose().lazyProduct(coupling - translation.traces);
  LocalFields fields = solve(right, -load);
  // Near incompressibility Zᵀ M Z is badly conditioned; one correction brings the volume's strain to its
  // digits.
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
      lifted_(compliance_.solve(b_.transpose())) {}

LocalMatrix AugmentedElimination::stiffness() const {
  return coupling_ * LocalMatrix(compliance_.solve(coupling_.transpose()));
}

LocalMatrix AugmentedElimination::coupling() const {
  return coupling_ * lifted_;
}

LocalMatrix AugmentedElimination::divergence() const {
  return b_ * lifted_;
}

LocalVector AugmentedElimination::stress(const LocalVector& coupling, const LocalVector& w) const {
  return compliance_.solve(coupling_.transpose() * coupling) - lifted_.lazyProduct(w);
}

}  // namespace signorini
