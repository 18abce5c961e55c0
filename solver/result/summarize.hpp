#pragma once

#include <functional>
#include <memory>

#include "certify/certificate.hpp"
#include "fem/discretization.hpp"
#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "solution.hpp"

namespace signorini {

/// How far a foundation may be, in displacements, before it is drawn near: a larger gap would drown them.
inline constexpr double kFar = 1e4;

/// The discrete fields that a method found.
struct Fields {
  Eigen::MatrixXd stress;        ///< a column a triangle
  Eigen::MatrixXd displacement;  ///< a column a triangle
  Eigen::VectorXd clearance;     ///< the contact unknowns
  Eigen::VectorXd coupling;      ///< traces, rotations and clearances, as TraceSpace numbers them
  Outcome outcome = Outcome::converged;
};

Timings timings(const Progress& progress);

/// <−σ_n, φ_i> / <1, φ_i> from the forces <−σ_n, φ_i> for every row of the clearance space. A node that a
/// fixed part holds clear of the foundation has none: what acts there is the support's.
Eigen::VectorXd contact_pressure(const ClearanceSpace& space, const Eigen::VectorXd& forces);

/// Clearance and pressure, an entry a row of the clearance space, by parts. Rows that touch in the same node
/// of an arc have their pressure in common.
std::vector<ContactPart> contact_parts(const ClearanceSpace& space, const Mesh& mesh,
                                       const Eigen::VectorXd& clearance, const Eigen::VectorXd& by_rows);

ContactSummary sum_up(const std::vector<ContactPart>& parts);

/// From the values of the part's reactions_on().
Reaction make_reaction(std::string part, const std::vector<double>& values);

/// Everything that a solution tells beyond the fields but its error bound, computed from the fields alone:
/// contact pressures, residuals, energy, sums, fields for pictures. Throws SolveError if a number is not
/// finite. Takes stress and displacement out of the fields; `mesh` is that of the discretization.
Solution describe(const Discretization& discrete, std::shared_ptr<const Mesh> mesh, Fields& fields,
                  const Settings& settings, Progress& progress);

/// Stress and bound are rounding beside what displacement and clearance might have made, as of a body that
/// moves without strain. A pressure at which the stress is rounding acts over the clearance, so that of the
/// bound the square is.
bool is_at_rest(const Problem& problem, const Solution& solution, const ErrorBound& bound);

/// Enters the phase certify and adds the error bound, if its numbers are finite, and what must be said about
/// it. If the time is up before, there is none, and the outcome says so.
void add_bound(const Problem& problem, const std::function<Certificate()>& certify, Solution& solution,
               Progress& progress);

}  // namespace signorini
