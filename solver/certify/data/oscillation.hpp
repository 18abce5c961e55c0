#pragma once

#include "certify/data/law_pieces.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// What the discrete equilibrium leaves out of the load, in the energy norm: a bound of
///
///     (r − Π₁r, w) + <q − Π₁q, w>  ≤  oscillation · ‖w‖_E,   r = f − Πf,   q = t − Πt, on Γ_C q = −(p* − p)
///     d,
///
/// on one triangle, of which load_remainder() is the part of r, for every displacement w: with the
/// projections Π₁ onto P1 w counts only up to linear functions, linear_remainder(). p is the linear pressure
/// with the force and the moment of a steep p*. What the integrals are off by makes Π₁r and Π₁q; they are
/// carried elsewhere, carried_loads.hpp.
template <int D>
double oscillation(const Discretization& discrete, int t, double of_load, const ContactPressure& pressure,
                   const LawOnMesh& laws);

/// (r − Π₁r, w) is at most this times ‖∇w‖, or ‖ε(w)‖ of an elastic body, on the triangle: no matter the
/// material and the contact. The budget is for a load that jumps.
template <int D>
double load_remainder(const Discretization& discrete, int t, CellBudget& budget);

/// Of each triangle of the mesh that has an owner (an entry of at least 0), all by one budget; 0 of the
/// others.
Eigen::VectorXd load_remainders(const Discretization& discrete, const std::vector<int>& owners,
                                Progress& progress);
/// Of all triangles.
Eigen::VectorXd load_remainders(const Discretization& discrete, Progress& progress);
/// The same of oscillation(), with the entries of load_remainders().
Eigen::VectorXd oscillations(const Discretization& discrete, const Eigen::VectorXd& of_load,
                             const ContactPressure& pressure, const LawOnMesh& laws,
                             const std::vector<int>& owners, Progress& progress);

}  // namespace signorini
