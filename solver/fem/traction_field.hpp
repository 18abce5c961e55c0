#pragma once

#include <unordered_map>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// The traction t on one edge of Γ_F as scheme and certificate see it, by its projection Πt onto P2. The
/// integrals are known as those of a load are: ProjectedLoad.
struct ProjectedTraction {
  /// Πt at the first point of the edge, at the second, and in the middle; a row a component.
  Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 2, 3> balanced;
  double rest = 0;  ///< ‖t − Πt‖ is at most this
  /// <t − Πt, φ> is at most this times max |φ|, for linear and for quadratic φ.
  double uncertain_force = 0, uncertain_work = 0;
};

/// The traction t on the edges of Γ_F, also where it is given as a pressure.
class TractionField {
 public:
  /// `progress` may be null; else throws what it throws.
  TractionField(const Problem& problem, const Mesh& mesh, Progress* progress = nullptr);

  bool acts_on(int edge) const { return projected_.contains(edge); }
  const ProjectedTraction& operator[](int edge) const { return projected_.at(edge); }
  /// A component of Πt at s ∈ [0, 1] from the first to the second point of an edge on which it acts.
  double operator()(int edge, int component, double s) const;
  /// Why what it says of t is not certain; empty if it is.
  const std::vector<std::string>& unmet() const { return unmet_; }

 private:
  std::unordered_map<int, ProjectedTraction> projected_;  ///< of the edges with a traction
  std::vector<std::string> unmet_;
};

}  // namespace signorini
