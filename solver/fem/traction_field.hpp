#pragma once

#include <unordered_map>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"

namespace signorini {

/// The traction t on the edges of Γ_F, also where it is given as a pressure.
class TractionField {
 public:
  TractionField(const Problem& problem, const Mesh& mesh);

  bool acts_on(int edge) const { return conditions_.contains(edge); }
  /// A component at s ∈ [0, 1] from the first to the second point of an edge on which it acts.
  double operator()(int edge, int component, double s) const;

 private:
  const Mesh& mesh_;
  std::unordered_map<int, const Condition*> conditions_;  ///< of the edges with a traction
};

}  // namespace signorini
