#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/elasticity/edge_tractions.hpp"
#include "certify/membrane/balance_stream_function.hpp"
#include "certify/pressure/contact_pressure.hpp"

namespace signorini {

/// v, and σ* by the pressure that it has on Γ_C and, for a membrane, the stream function that spreads its
/// balance, for an elastic body the tractions on all edges.
struct AdmissiblePair {
  AdmissibleDisplacement v;
  ContactPressure pressure;
  std::optional<QuadraticValues> of_balance = std::nullopt;
  std::optional<EdgeTractions> tractions = std::nullopt;

  /// Why it is not admissible, in words; empty if it is.
  std::vector<std::string> unmet() const;

  /// Of a membrane: the stream function, on a triangle, whose curl σ* has besides σ_h and its balance.
  Quadratic<1> stream_function_on(const Mesh& mesh, int t) const {
    const Quadratic<1> of_pressure = pressure.stream_function_on(mesh, t);
    return of_balance ? Quadratic<1>(of_pressure + of_balance->on(mesh, t)) : of_pressure;
  }
};

/// The pair of a discrete solution, made as close as pays. `coupling`: the unknowns of the trace space.
AdmissiblePair admissible_pair(const Discretization& discrete, const Solution& solution,
                               const Eigen::VectorXd& coupling, Progress& progress);

/// The pair (η, τ) of a dual problem beside that of the base: the gap of its problem is w, and on Γ_C
/// |w − η_n| ≤ K (g − v_n) and |p_τ| ≤ K p* (THEORY.md, Theorem 4), with a K as near to the factor as can be.
/// `of_balance`: stream_function_of_balance().
AdmissiblePair dual_pair(const Discretization& discrete, const Solution& solution,
                         const Eigen::VectorXd& coupling, std::optional<QuadraticValues> of_balance,
                         const AdmissiblePair& base, double factor, Progress& progress);

}  // namespace signorini
