#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/displacement/largest_coefficient.hpp"
#include "certify/displacement/recovered_displacement.hpp"

namespace signorini {
namespace {

/// Between the ends of an edge K is hardly ever more than so many times what it is there.
constexpr double kNearEnds = 1.5;

}  // namespace

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                                               const Eigen::VectorXd& coupling,
                                               const AdmissibleDisplacement& base, double factor,
                                               Progress& progress)
    : AdmissibleDisplacement(discrete, displacement_at_corners(discrete, solution, progress), coupling) {
  beside_ = {&base, factor};
  constrain_points();
  constrain_beside_base();
  admit_points();
  set_middles(coupling, progress);
  meet_supports();
  CellBudget budget{kCellsOfGaps, &progress};
  const std::vector<ContactEdge>& edges = discrete.clearance.edges;
  double needed = 0;
  for (std::size_t i = 0; i < edges.size(); ++i)
    budget.share(edges.size() - i,
                 [&](CellBudget& own) { needed = std::max(needed, meet_base(edges[i], own)); });
  beside_.factor = needed;
}

double AdmissibleDisplacement::beyond_base(const ContactEdge& contact) const {
  const auto found = beside_.beyond.find(contact.edge);
  return found == beside_.beyond.end() ? 0 : found->second;
}

bool AdmissibleDisplacement::touches_base(const ContactEdge& contact, int k) const {
  return beside_.base->room(contact, k) <= kSmall * beside_.base->scale_;
}

/// |w − η_n| ≤ K (g − v_n) at the ends of edges. What is fixed is what it is: then K is as large as it must.
void AdmissibleDisplacement::constrain_beside_base() {
  const auto for_ends = [&](const auto& visit) {
    for (const ContactEdge& contact : discrete_.clearance.edges)
      for (int k = 0; k < 2; ++k) visit(contact, k, discrete_.mesh.edges[contact.edge][k]);
  };
  // A weight may have all that it has between the ends.
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    const EdgeLine line(discrete_.mesh, contact.edge);
    const Interval along = series_on(gap(contact), line, Interval(0, 1), 0)[0];
    if (is_known(along)) scale_ = std::max(scale_, largest(along));
  }
  for_ends([&](const ContactEdge& contact, int k, int point) {
    const double w = gap_at(contact, k);
    scale_ = std::max(scale_, std::abs(w));
    if (!fixed_points_.contains(point) || touches_base(contact, k)) return;
    // Of η there are the values in the points alone by now.
    const double off = std::abs(w - direction(contact).dot(points_.col(point)));
    beside_.factor = std::max(beside_.factor, off / beside_.base->room(contact, k));
  });
  for_ends([&](const ContactEdge& contact, int k, int point) {
    const double w = gap_at(contact, k), rounding = discrete_.mesh.rounding_of_normal(contact.edge),
                 most = touches_base(contact, k) ? 0 : beside_.factor * beside_.base->room(contact, k);
    const Eigen::VectorXd d = direction(contact);
    constrain(point, {d, w + most, false, false, rounding});
    constrain(point, {-d, most - w, false, false, rounding});
  });
}

/// Where v touches, η_n is w − κ (g − v_n) with κ ∈ [−K, K] such that both ends are what they are: v may open
/// there as slowly as it likes. Elsewhere η_n stays the quadratic that it is, unless that leaves its bounds.
/// Answers the K that it needs.
double AdmissibleDisplacement::meet_base(const ContactEdge& contact, CellBudget& budget) {
  if (!is_known_on_edges(gap(contact)))
    refuse(gap(contact).name() + " is a function that is known in single points only: give a formula");
  const double most = beside_.factor;
  std::array<double, 2> ratios{0, 0};
  const std::array<bool, 2> touches{touches_base(contact, 0), touches_base(contact, 1)};
  for (const int k : {0, 1}) {
    const double off = room(contact, k), open = touches[k] ? 0 : beside_.base->room(contact, k);
    if (std::abs(off) > most * open + kNearly * scale_)
      refuse_point(discrete_.mesh.edges[contact.edge][k]);
    else if (!touches[k])
      ratios[k] = std::clamp(off / open, -most, most);
  }
  for (const int k : {0, 1})
    if (touches[k]) ratios[k] = ratios[1 - k];
  const double at_ends = std::max(std::abs(ratios[0]), std::abs(ratios[1])),
               rounding = kSmall * (scale_ + most * beside_.base->scale_);
  double& beyond = beside_.beyond[contact.edge];
  if (!touches[0] && !touches[1])
    for (const double factor : {std::min(kNearEnds * at_ends, most), most}) {
      const auto [above, below] = bubbles_beyond_base(contact, factor, budget);
      beyond = std::max(above, below);
      if (beyond <= rounding) return factor;
    }
  beyond = follow_base(contact, ratios);
  if (std::isfinite(beyond)) return at_ends;
  const double factor = beside_.base->lift(contact.edge) ? 0 : most;
  beyond = stay_between_bubbles(contact, factor, budget);
  if (!std::isfinite(beyond))
    refuse(gap(contact).name() + " jumps, or changes without bound, near " +
           to_string(EdgeLine(discrete_.mesh, contact.edge).at(0.5)));
  return factor;
}

/// Half of what both bubbles are together, with η_n in the middle between them.
double AdmissibleDisplacement::stay_between_bubbles(const ContactEdge& contact, double factor,
                                                    CellBudget& budget) {
  const auto [above, below] = bubbles_beyond_base(contact, factor, budget);
  if (!std::isfinite(above + below)) return std::numeric_limits<double>::infinity();
  middles_.col(contact.edge) += (below - above) / 2 * direction(contact);
  return (above + below) / 2;
}

/// Multiples of the bubble 4 s (1 − s) by which the quadratic η_n is above w + K (g − v_n) and below w − K (g
/// − v_n) at most.
std::array<double, 2> AdmissibleDisplacement::bubbles_beyond_base(const ContactEdge& contact, double factor,
                                                                  CellBudget& budget) const {
  const AdmissibleDisplacement& base = *beside_.base;
  const Field& g = base.gap(contact);
  std::array<double, 2> bubbles{std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::infinity()};
  const auto has_series = [](const Field& field) { return field.is_constant() || field.formula(); };
  if (!has_series(g) || !has_series(gap(contact))) return bubbles;
  const EdgeLine line(discrete_.mesh, contact.edge);
  for (const double sign : {1., -1.}) {
    const Field sum = Field(0, gap(contact).name()).plus(sign, gap(contact)).plus(factor, g);
    const auto along = [&](double s) {
      return sign * along_contact(contact, s) + factor * base.along_contact(contact, s);
    };
    const auto own_room = [&](double s) { return sign * room(contact, s) + factor * base.room(contact, s); };
    bubbles[sign > 0 ? 0 : 1] =
        BelowGap{sum, line, {along(0), along(0.5), along(1)}, {own_room(0), own_room(1)}}.bubble(budget);
  }
  return bubbles;
}

/// η_n = w − κ (g − v_n), but for a multiple of the bubble 4 s (1 − s) that it answers; κ is linear, with the
/// given values at the ends. Infinite where w or g are not smooth.
double AdmissibleDisplacement::follow_base(const ContactEdge& contact, const std::array<double, 2>& ratios) {
  const AdmissibleDisplacement& base = *beside_.base;
  const EdgeLine line(discrete_.mesh, contact.edge);
  const Eigen::VectorXd n = direction(contact);
  const auto off = [&](double s) {
    return room(contact, s) - ((1 - s) * ratios[0] + s * ratios[1]) * base.room(contact, s);
  };
  middles_.col(contact.edge) += off(0.5) * n;
  const auto coefficient = [&](const Field& field, int order) {
    return field.formula() ? largest_coefficient(field, line, order, small_coefficient()) : 0;
  };
  double ninth = coefficient(gap(contact), Lift::kDegree + 1);
  if (const double largest = std::max(std::abs(ratios[0]), std::abs(ratios[1])); largest > 0)
    ninth += largest * coefficient(base.gap(contact), Lift::kDegree + 1);
  if (const double change = std::abs(ratios[1] - ratios[0]); change > 0)
    ninth += change * coefficient(base.gap(contact), Lift::kDegree);
  if (!std::isfinite(ninth)) return ninth;
  add_lift(contact.edge, [&](double s) -> Eigen::VectorXd { return off(s) * n; });
  return ninth * Lift::errors().over_bubble;
}

}  // namespace signorini
