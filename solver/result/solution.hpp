#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"
#include "progress/observer.hpp"

namespace signorini {

/// How a solve ended. `tolerance_not_met` and `cancelled` are for meshes that refine themselves, which have
/// an answer of the meshes before. Stored as numbers: a new one ends the list.
enum class Outcome {
  converged,
  iteration_limit,
  time_limit,
  diverged,
  tolerance_not_met,
  cancelled,
  stalled  ///< the method met its own criterion, but the residuals say that this is no answer
};

/// `converged`, `iteration_limit` and so on, the name as it stands above.
const char* name(Outcome outcome);

/// The discrete fields on one part of the contact boundary, one row a contact edge (its midpoint, P0) or
/// one a node in the order along the part (P1; two where the direction of the contact turns).
struct ContactPart {
  std::string name;
  std::vector<Point> points;
  std::vector<double> clearance;  ///< λ = g − u_n ≥ 0, a length
  /// −σ_n, <−σ_hn, φ_i> / <1, φ_i> for the basis function φ_i of the row, or for the sum of those that touch
  /// in the same node of an arc. At a node shared with a fixed part it holds the support's reaction too and
  /// may be negative if the node touches, and is 0 if not.
  std::vector<double> pressure;
  std::vector<double> gap;     ///< g
  std::vector<double> weight;  ///< <1, φ_i>, the length that the row stands for
  std::vector<bool> open;      ///< λ > 0
};

/// What is left of each condition of Problem 4.1, relative and without unit; see contact/residuals.hpp.
struct Residuals {
  double equilibrium = 0;      ///< (div σ_h + f, v) = 0, and the continuity of σ_h n, and σ_h n = t
  double constitutive = 0;     ///< the first equation of Problem 4.1
  double penetration = 0;      ///< λ_h ≥ 0
  double tension = 0;          ///< σ_hn ≤ 0
  double complementarity = 0;  ///< λ_h σ_hn = 0
  double symmetry = 0;         ///< σ_h = σ_hᵀ; nothing to violate for a membrane
};

/// Numbers of unknowns: of the conforming spaces of Problem 4.1, not of the system that is factored.
struct Unknowns {
  std::int64_t stress = 0;
  std::int64_t displacement = 0;
  std::int64_t contact = 0;
  std::int64_t rotation = 0;
};

/// Sums over all contact parts.
struct ContactSummary {
  double force = 0;  ///< ∫ p ds
  double max_pressure = 0;
  double length = 0;  ///< of the closed part
};

/// What the surroundings exert on the body through one boundary part: ∫ σn ds and its moment ∫ x × σn ds
/// about the origin. A membrane has one component of force and no moment.
struct Reaction {
  std::string part;
  std::vector<double> force;
  double moment = 0;
};

/// A pressure on an edge of Γ_C, linear on the part from s = begin to s = end of it and 0 beside that.
struct EdgePressure {
  int edge;
  std::array<double, 2> at_ends;  ///< of the part
  double begin = 0, end = 1;

  double operator()(double s) const {
    if (s < begin || s > end) return 0;
    return ((end - s) * at_ends[0] + (s - begin) * at_ends[1]) / (end - begin);
  }
};

/// What is taken for the number of the solution that lies between two others, by that of the discrete one:
/// that itself, the nearer end if it lies outside by rounding alone, or the middle; without a middle the
/// nearer end.
inline double estimate_within(double value, double lower, double upper) {
  constexpr double rounding = 1e-9;  // of the interval
  const double nearest = std::clamp(value, lower, upper), width = upper - lower;
  return !std::isfinite(width) || std::abs(value - nearest) <= rounding * width ? nearest
                                                                                : (lower + upper) / 2;
}

/// A number of the discrete solution with an interval that holds that of the solution.
struct EnclosedNumber {
  double value = 0;     ///< of the discrete solution
  double estimate = 0;  ///< estimate_within() the interval
  /// Infinite where nothing finite is known.
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();

  bool has_lower() const { return std::isfinite(lower); }
  bool has_upper() const { return std::isfinite(upper); }
  bool is_bounded() const { return has_lower() && has_upper(); }
};

/// The value in its interval, with the estimate that follows from both.
inline EnclosedNumber enclosed_number(double value, double lower, double upper) {
  return {value, estimate_within(value, lower, upper), lower, upper};
}

/// What is known of a stretch of a contact part. Of single points nothing is: an elastic body may lift off in
/// any.
struct CertifiedStretch {
  Point begin, end;
  bool touches = false;                   ///< somewhere within
  std::optional<double> carries_at_most;  ///< ∫ p over it
  std::optional<double> opens_at_most;    ///< ∫ λ over it
};

/// What one support takes, or several together, as a Reaction; of a contact part the force of its pressure
/// too. A number is there if something is known of it.
struct CertifiedSupport {
  std::vector<std::string> parts;
  std::vector<EnclosedNumber> force;  ///< by components
  std::optional<EnclosedNumber> moment, pressure_force;
  std::vector<CertifiedStretch> stretches;  ///< of a contact part, one after the other
};

/// What the certificate knows of numbers that every answer has, all of it guaranteed.
struct Certified {
  EnclosedNumber energy;
  EnclosedNumber work;  ///< of the loads, (f, u) + <t, u>
  std::vector<CertifiedSupport> supports;
  std::vector<std::string> unmet;  ///< why some of it is not bounded
};

/// A bound of the error in the energy norm, computed from the solution alone; see certify/certificate.hpp.
/// Its parts are norms of the same unit, √(energy per unit depth).
struct ErrorBound {
  struct Parts {
    double constitutive = 0;   ///< ‖σ* − E ε(v)‖_C
    double contact = 0;        ///< √(2 <p*, g − v_n>)
    double oscillation = 0;    ///< of the load and the traction
    double equilibration = 0;  ///< ‖σ* − sym σ_h‖_C
    double asymmetry = 0;      ///< ‖skew σ_h‖_C
  };

  double value = 0;
  double relative = 0;  ///< value / ‖σ_h‖_C
  bool guaranteed = false;
  std::vector<std::string> unmet;  ///< why it is not guaranteed
  double energy_lower = 0;         ///< ≤ J(u)
  double energy_upper = 0;         ///< J(v) ≥ J(u)
  EnclosedNumber work;             ///< of the loads, (f, u) + <t, u>
  Parts parts;
};

/// A quantity that was asked for, with the interval that the certificate knows.
struct EnclosedQuantity {
  std::string name;
  double value = 0;     ///< of the discrete solution
  double estimate = 0;  ///< estimate_within() the interval
  /// The interval; infinite where nothing finite is known.
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  bool guaranteed = false;
  std::vector<std::string> unmet;  ///< why it is not guaranteed
  /// Entry t: about what triangle t adds to the width of the interval, up to a factor.
  Eigen::VectorXd shares;

  EnclosedQuantity& operator*=(double factor) {
    for (double* own : {&value, &estimate, &lower, &upper}) *own *= factor;
    return *this;
  }

  bool is_bounded() const { return std::isfinite(lower) && std::isfinite(upper); }
  /// 0 where it is known exactly, though it be 0.
  double relative_width() const { return upper > lower ? (upper - lower) / std::abs(estimate) : 0; }
};

/// Seconds.
struct Timings {
  double mesh = 0;
  double assemble = 0;
  double factorize = 0;
  double iterate = 0;
  double certify = 0;
  double total = 0;
};

struct Summary {
  Outcome outcome = Outcome::converged;
  std::string advice;              ///< empty if converged, else why not and what to try
  std::vector<std::string> notes;  ///< sentences on what was done that the problem did not ask for
  std::string method;              ///< `uzawa` or `active_set`
  int iterations = 0;
  std::int64_t triangles = 0;
  Unknowns unknowns;
  double energy = 0;  ///< primal energy ½(Cσ,σ) − (f,u) − <t,u> at the discrete solution
  Residuals residuals;
  ContactSummary contact;
  std::optional<ErrorBound> error_bound;  ///< none if nothing finite is known; the notes say why
  std::vector<Reaction> parts;
  std::vector<EnclosedQuantity> quantities;  ///< in the order of the problem
  std::optional<Certified> certified;        ///< if the bound is guaranteed
  std::vector<Level> levels;                 ///< of a mesh that refined itself
  bool reused = false;                       ///< the operator was there from an earlier solve
  Timings timings;
  std::int64_t peak_memory_bytes = 0;  ///< that solving it took, its sweep and its study with it
};

/// What a solve found out about one variation of a problem; everything but what stands here is as in the
/// summary of the problem itself.
struct SweepEntry {
  std::string title;
  std::string error;  ///< empty, or why there is no solution; then the rest is empty too
  Outcome outcome = Outcome::converged;
  std::string advice;  ///< empty if converged, else why not and what to try
  int iterations = 0;
  double energy = 0;
  double penetration = 0, tension = 0, complementarity = 0;  ///< relative residuals
  ContactSummary sums;
  std::vector<Reaction> parts;
  double seconds = 0;
  std::vector<ContactPart> contact;
  std::optional<ErrorBound>
      error_bound;  ///< none if its fields were not computed, or nothing finite is known
  std::vector<EnclosedQuantity> quantities;  ///< in the order of the problem
};

inline bool is_solved(const SweepEntry& entry) {
  return entry.error.empty() && entry.outcome == Outcome::converged;
}

/// Errors against the exact solution, each where that is known.
struct TrueErrors {
  std::optional<double> displacement;  ///< ‖u − u_h‖ in L2
  std::optional<double> stress;        ///< ‖σ − σ_h‖ in L2
  std::optional<double> energy_norm;   ///< ‖σ − σ_h‖_C
  std::optional<double> energy;        ///< |J(u) − J_h|
  /// What the error bound bounds: √(‖σ − σ_h‖²_C + 2 (J(v) − J(u)) + 2 <p*, g − u_n>) with its v and p*,
  /// where 2 (J(v) − J(u)) = ‖ε(u − v)‖²_E + 2 <p, g − v_n>. The last term counts if u is known, on the
  /// edges of Solution::admissible_pressure. On patches the bound knows <p, g − v_n> of two pairs together
  /// only (certify/THEORY.md, Theorem 3).
  std::optional<double> total;
};

/// What is seen of a level of a mesh that refined itself; members as in Solution.
struct LevelFields {
  int number = 0;  ///< from 1
  std::vector<Point> points;
  std::vector<std::array<int, 3>> triangles;
  Eigen::MatrixXd displacement_at_points;
  Eigen::VectorXd error_squares;
};

/// The numbers of one mesh and scheme of a study.
struct StudyRow {
  Scheme scheme = Scheme::nonconforming;
  std::string error;  ///< empty, or why there is no solution; then there are no numbers
  int level = 0;      ///< of a mesh that refines itself, from 1; else 0
  double size = 0;    ///< the largest edge length
  std::int64_t triangles = 0;
  Unknowns unknowns;
  double energy = 0;
  std::optional<ErrorBound> error_bound;
  std::vector<EnclosedQuantity> quantities;  ///< in the order of the problem
  TrueErrors errors;
  std::optional<double> inf_sup;  ///< β_h of fem/inf_sup.hpp, if the study asks for it
  int iterations = 0;
  double seconds = 0;  ///< of the solve; of a level since the start of the first one
};

/// Everything that a solve found out.
struct Solution {
  Summary summary;
  Scheme scheme = Scheme::nonconforming;
  /// Shared with the operator, and with others that are solved on it; empty, but there, if there is none.
  std::shared_ptr<const Mesh> mesh = std::make_shared<const Mesh>();

  /// 1 for a membrane, 2 for an elastic body.
  int components = 1;
  /// Column t: the coefficients of σ_h on triangle t in the basis of fem/raviart_thomas.hpp (outward
  /// fluxes first, edge by edge), the rows of the stress together: function a of row c is a · components + c.
  Eigen::MatrixXd stress;
  /// Column t: the value of u_h on triangle t (P0), or its three corner values (P1), the components of a
  /// value together.
  Eigen::MatrixXd displacement;
  /// The rotation ½ (∂_y u_x − ∂_x u_y) at the points of the mesh; empty for a membrane.
  Eigen::VectorXd rotation;
  /// Column p: a continuous reconstruction of u at point p of the mesh.
  Eigen::MatrixXd displacement_at_points;
  /// Column t: (σ_x, σ_y), or (σ_xx, σ_yy, σ_xy), at the centroid of triangle t.
  Eigen::MatrixXd stress_at_centroids;
  /// σ_zz at the centroids of an elastic body: ν (σ_xx + σ_yy) in plane strain, 0 in plane stress and for a
  /// tensor, which says nothing about it. Empty for a membrane.
  Eigen::VectorXd out_of_plane_stress;

  /// Entry t: what triangle t adds to the square of the error bound. Empty if there is none.
  Eigen::VectorXd error_squares;
  /// p* ≥ 0 of the error bound on the edges where it is not 0, but for those where several pairs stand for
  /// one (certify/patches/patch_pairs.hpp).
  std::vector<EdgePressure> admissible_pressure;

  std::vector<ContactPart> contact;
  std::vector<Iteration> history;

  std::vector<SweepEntry> sweep;    ///< an entry a variation
  std::vector<StudyRow> study;      ///< the table of a study, scheme by scheme
  std::vector<LevelFields> levels;  ///< of a mesh that refined itself, all but the one whose fields these are
};

}  // namespace signorini
