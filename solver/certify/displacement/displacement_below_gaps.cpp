// How v_h stays below the gaps between the points.

#include <algorithm>
#include <cmath>

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/displacement/largest_coefficient.hpp"
#include "fem/edge_pieces.hpp"

namespace signorini {
namespace {

/// None takes more than a fifth of what the others have left.
constexpr int kShares = 5;

/// How far a field is from the straight line between its values at the ends of the edge, in some points.
double bend(const Field& field, const EdgeLine& line) {
  const double begin = line.value(field, 0), end = line.value(field, 1);
  double most = 0;
  for (int i = 1; i < Lift::kDegree; ++i) {
    const double s = 1. * i / Lift::kDegree;
    most = std::max(most, std::abs(line.value(field, s) - (1 - s) * begin - s * end));
  }
  return most;
}

}  // namespace

void AdmissibleDisplacement::meet(const ContactEdge& contact, CellBudget& budget) {
  if (!is_known_on_edges(gap(contact)))
    refuse(gap(contact).name() + " is a function that is known in single points only: give a formula");
  const auto& [a, b] = discrete_.mesh.edges[contact.edge];
  for (const int k : {0, 1})
    if (room(contact, k) < -kNearly * scale_) return refuse_point(k == 0 ? a : b);
  const Eigen::VectorXd n = direction(contact);
  const auto touches_in = [&](int point, int k) {
    return std::abs(n.dot(points_.col(point)) - gap_at(contact, k)) <= kSmall * scale_;
  };
  if (follows_gap(contact) && touches_in(a, 0) && touches_in(b, 1))
    close(contact);
  else
    lower_below(contact, budget);
}

/// Where a polynomial is off by more than the gap differs from a straight line, as where it has many waves on
/// an edge, to stay below the gap is better than to follow it.
void AdmissibleDisplacement::find_followed_gaps(Progress& progress) {
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    progress.check();
    if (clearance_[contact.rows[0]] > 0 || clearance_[contact.rows[1]] > 0) continue;
    const Field& own = gap(contact);
    const EdgeLine line(discrete_.mesh, contact.edge);
    const double ninth =
        own.formula() ? largest_coefficient(own, line, Lift::kDegree + 1, small_coefficient()) : 0;
    const double off = ninth * Lift::errors().over_bubble;
    if (off <= kNearly * scale_ || off <= bend(own, line)) off_gap_.emplace(contact.edge, off);
  }
}

/// v_n = g, but for what the polynomial is off by, as a multiple of the bubble 4 s (1 − s).
void AdmissibleDisplacement::close(const ContactEdge& contact) {
  const int edge = contact.edge;
  const Eigen::VectorXd n = direction(contact);
  middles_.col(edge) += room(contact, 0.5) * n;
  add_lift(edge, [&](double s) -> Eigen::VectorXd { return room(contact, s) * n; });
  middles_.col(edge) -= off_gap_.at(edge) * n;
}

BelowGap AdmissibleDisplacement::below_gap(const ContactEdge& contact, const EdgeLine& line) const {
  return {gap(contact),
          line,
          {along_contact(contact, 0), along_contact(contact, 0.5), along_contact(contact, 1)},
          {room(contact, 0), room(contact, 1)}};
}

/// Where bubbles alone would be high, BelowGap::level(): v changes by what is linear on the triangles around
/// a point, which keeps what is below the gap there.
void AdmissibleDisplacement::lower_points(CellBudget& budget) {
  const Mesh& mesh = discrete_.mesh;
  std::map<int, std::vector<PointConstraint>> lower;
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    if (follows_gap(contact) || !is_known_on_edges(gap(contact))) continue;
    const EdgeLine line(mesh, contact.edge);
    double level = 0;
    budget.share(kShares, [&](CellBudget& own) { level = below_gap(contact, line).level(own); });
    if (level == 0) continue;
    for (const int k : {0, 1}) {
      const int point = mesh.edges[contact.edge][k];
      if (!fixed_points_.contains(point))
        lower[point].push_back({direction(contact), along_contact(contact, k) - level, false});
    }
  }
  if (lower.empty()) return;
  Eigen::MatrixXd change = Eigen::MatrixXd::Zero(components_, points_.cols());
  for (auto& [point, own] : lower) {
    for (PointConstraint known : constraints_[point]) {
      known.equality = known.is_roller;
      own.push_back(std::move(known));
    }
    if (const auto nearest = nearest_admissible(points_.col(point), own, scale_))
      change.col(point) = *nearest - points_.col(point);
  }
  points_ += change;
  for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
    middles_.col(edge) += (change.col(mesh.edges[edge][0]) + change.col(mesh.edges[edge][1])) / 2;
}

/// v_n ≤ g by a multiple of the bubble 4 s (1 − s).
void AdmissibleDisplacement::lower_below(const ContactEdge& contact, CellBudget& budget) {
  const EdgeLine line(discrete_.mesh, contact.edge);
  double needed = 0;
  budget.share(kShares, [&](CellBudget& own) { needed = below_gap(contact, line).bubble(own); });
  if (!std::isfinite(needed))
    refuse(is_known(series_on(gap(contact), line, Interval(0, 1), 0)[0])
               ? gap(contact).name() + " falls from what is fixed beside " + to_string(line.at(0.5)) +
                     " without bound on its slope: raise it there, or lower what is fixed"
               : not_known_to_be_finite(gap(contact), line.at(0.5)));
  else if (needed > 0)
    middles_.col(contact.edge) -= needed * direction(contact);
}

}  // namespace signorini
