#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "fem/scheme.hpp"
#include "mesh/mesh.hpp"

namespace signorini {

/// Of unit vectors that rounding may have turned by this angle, such as the normals along a straight line.
inline bool is_same_direction(const Vector& one, const Vector& other, double rounding) {
  return one.dot(other) > 0 && std::abs(one.x() * other.y() - one.y() * other.x()) <= rounding;
}

/// One function φ_i of the clearance space: the indicator of a contact edge (P0), or the hat of a node of
/// a contact part (P1, continuous along the part but where its direction turns: u_n jumps there).
struct ClearanceRow {
  int part;           ///< index of the boundary part
  Point point;        ///< midpoint of the edge, or the node
  double gap;         ///< mean of g over the edge, or g at the node
  double weight = 0;  ///< <1, φ_i>, a length
  int unknown = -1;   ///< number among the contact unknowns; -1 at a node shared with Γ_D
  double datum = 0;   ///< λ = g − u_D·n at a node shared with Γ_D
  double beyond = 0;  ///< what g and λ are larger by in truth, if the foundation was drawn near
};

/// One edge of Γ_C: its local trace functions j (from its first to its second point) carry
/// m_n = Πg_j − λ_{row j}.
struct ContactEdge {
  int edge;
  std::array<int, 2> rows;    ///< the same twice for P0
  std::array<double, 2> gap;  ///< Πg, the L2 projection of g onto P_k on the edge
  Vector direction;           ///< the unit vector that u_n is taken along: n unless the condition names one
};

/// Λ_h, the space of the clearance on Γ_C (solver/README.md, "The two schemes").
///
/// On an arc the gap is asked at the arc, not at its chord. With x(s) on the chord, X(s) the point of the arc
/// nearest to it and n(X) the arc's normal, the condition is
///
///     u_n(x) ≤ g(X, n(X)),     u_n = u·d with the direction d of the condition, or the chord's normal.
///
/// For what touches is the arc: the body's point X, which moves by u(X) = u(x) + O(h²/R |∇u|), has the gap
/// g(X). The chord's point x lies τ = h²/8R or less behind it, but has the material between them before it,
/// so that τ is no part of its gap. To add it, as a gap read at the chord does, presses every node into the
/// foundation by τ more than the middle between two of them: a pressure of E τ/h = E h/8R that goes up and
/// down from edge to edge.
///
/// The chord's normal is the arc's in its middle, and their angle is h/2R at its ends (see contact_parts()).
struct ClearanceSpace {
  std::vector<ClearanceRow> rows;  ///< part by part, in order along each part
  std::vector<ContactEdge> edges;
  int unknowns = 0;
  /// The largest gap that the rows may have; where the foundation is farther away it was drawn near.
  double reach = std::numeric_limits<double>::infinity();

  /// The whole clearance, data included, from the contact unknowns.
  Eigen::VectorXd clearance(const Eigen::VectorXd& unknown) const;

  /// A foundation was drawn so near that something touches it.
  bool is_touched_too_early(const Eigen::VectorXd& unknown) const;
};

/// What clearances are of: of u, which no part holds beyond the gap, or of a change of it, which may have
/// either sign.
enum class ClearanceOf { solution, change };

/// Builds Λ_h and evaluates the gap. Throws InvalidProblem where a contact part begins beside a part that
/// holds the body beyond the gap, a fixed one, or a roller along the same line: v_n would have to jump there,
/// and no displacement of finite energy does. Where the directions of contact and roller differ, a
/// displacement may meet both.
///
/// `reach`: ClearanceSpace::reach. As long as nothing touches a foundation that was drawn near, the
/// displacement is the same, and it keeps the digits that it would lose beside a large gap.
ClearanceSpace make_clearance_space(const Problem& problem, const Mesh& mesh,
                                    double reach = std::numeric_limits<double>::infinity(),
                                    ClearanceOf of = ClearanceOf::solution);

}  // namespace signorini
