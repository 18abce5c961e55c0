#pragma once

#include <vector>

#include <Eigen/Core>

#include "progress/progress.hpp"

namespace signorini {

/// Multilevel diagonal scaling of the open part of a contact complement S (Zhang 1992, after Bramble, Pasciak
/// and Xu 1990): an approximate inverse
///
///     B = Σ_l P_l D_l⁻¹ P_lᵀ,   D_l the diagonal of P_lᵀ S P_l,   P_0 the identity,
///
/// in which P_l moves each aggregate of 2^l neighbours as one. S behaves as √−Δ on the contact boundary, so
/// that its own diagonal leaves a condition of 1/h, and this one of almost nothing. Neighbours are the
/// unknowns that S couples most strongly, so that no geometry is asked for.
class MultilevelScaling {
 public:
  /// Throws what Progress throws, here and later.
  MultilevelScaling(const Eigen::MatrixXd& s, Progress& progress);

  /// Of these unknowns alone from now on: rows and columns of S elsewhere count as 0. As dear as a product
  /// with S.
  void restrict_to(const std::vector<int>& open);

  /// B v for v = 0 outside the open part, where B v = 0 too.
  void apply(const Eigen::VectorXd& v, Eigen::VectorXd& out);

 private:
  /// Aggregates of the level below in pairs, or alone.
  struct Level {
    std::vector<int> aggregate;  ///< the aggregate of each below
    Eigen::VectorXd inverse;     ///< D_l⁻¹, 0 where nothing is open
    Eigen::VectorXd restricted;  ///< P_lᵀ v, then the sum of this level and the coarser ones
  };

  const Eigen::MatrixXd& s_;
  Progress& progress_;
  Eigen::VectorXd inverse_;  ///< D_0⁻¹
  std::vector<Level> levels_;
};

}  // namespace signorini
