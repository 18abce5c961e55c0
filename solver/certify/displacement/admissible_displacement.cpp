#include "certify/displacement/admissible_displacement.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/displacement/displacement_relaxation.hpp"
#include "certify/displacement/recovered_displacement.hpp"
#include "certify/displacement/relaxation.hpp"
#include "fem/edge_pieces.hpp"

namespace signorini {

const Field& gap_on(const Discretization& discrete, const ContactEdge& contact) {
  const std::string& part = discrete.mesh.boundary[discrete.clearance.rows[contact.rows[0]].part].name;
  return condition_on<Contact>(discrete.problem, part)->gap;
}

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& discrete, Eigen::MatrixXd points,
                                               const Eigen::VectorXd& coupling)
    : discrete_(discrete),
      components_(discrete.spaces().components),
      clearance_(discrete.clearance.clearance(coupling.tail(discrete.traces.contact_unknowns()))),
      points_(std::move(points)),
      scale_(points_.cwiseAbs().maxCoeff()) {}

AdmissibleDisplacement::AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                                               const Eigen::VectorXd& coupling, Progress& progress)
    : AdmissibleDisplacement(discrete, displacement_at_corners(discrete, solution, progress), coupling) {
  for (std::size_t i = 0; i < discrete.clearance.rows.size(); ++i)
    clearance_[i] += discrete.clearance.rows[i].beyond;
  constrain_points();
  constrain_to_gap();
  admit_points();
  if (components_ == 2) follow_traces();
  set_middles(coupling, progress);
  meet_supports();
  find_followed_gaps(progress);
  CellBudget budget{kCellsOfGaps, &progress};
  lower_points(budget);
  for (const ContactEdge& contact : discrete.clearance.edges) {
    progress.check();
    meet(contact, budget);
  }
}

void AdmissibleDisplacement::relax(const Eigen::VectorXd& work, int steps, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  QuadraticValues values(mesh);
  values.points = points_.row(0);
  values.middles = middles_.row(0);
  for (const auto& [point, value] : fixed_points_) values.held_points[point] = true;
  for (const BoundaryPart& part : mesh.boundary)
    if (condition_on<Fixed>(discrete_.problem, part.name))
      for (const int edge : part.edges) values.held_middles[edge] = true;
  const auto touches = [&](const ContactEdge& contact, int k) {
    return beside_.base || clearance_[contact.rows[k]] <= 0;
  };
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    values.held_middles[contact.edge] = touches(contact, 0) && touches(contact, 1);
    for (int k = 0; k < 2; ++k)
      if (touches(contact, k)) values.held_points[mesh.edges[contact.edge][k]] = true;
  }
  signorini::relax(discrete_, stiffness_of, values, work, steps, progress);
  points_.row(0) = values.points;
  middles_.row(0) = values.middles;
  if (beside_.base) return;
  for (const ContactEdge& contact : discrete_.clearance.edges)
    for (int k = 0; k < 2; ++k) {
      const int point = mesh.edges[contact.edge][k];
      const double lack = -room(contact, k);
      if (lack > 0 && !values.held_points[point]) points_.col(point) -= lack * direction(contact);
    }
  CellBudget budget{kCellsOfGaps, &progress};
  lower_points(budget);
  for (const ContactEdge& contact : discrete_.clearance.edges)
    if (!values.held_middles[contact.edge]) lower_below(contact, budget);
}

void AdmissibleDisplacement::relax_on_stars(int sweeps, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  const std::size_t points = mesh.points.size();
  std::vector<NodeFreedom> freedom(points + mesh.edges.size());
  for (const auto& [point, value] : fixed_points_) freedom[point].held = true;
  for (const BoundaryPart& part : mesh.boundary) {
    const bool rolls = condition_on<Roller>(discrete_.problem, part.name);
    for (const int edge : part.edges) {
      if (condition_on<Fixed>(discrete_.problem, part.name)) freedom[points + edge].held = true;
      if (!rolls) continue;
      const Vector n = mesh.outward_normal(edge);
      for (const std::size_t node :
           {std::size_t(mesh.edges[edge][0]), std::size_t(mesh.edges[edge][1]), points + edge})
        freedom[node].hold_along(n, mesh.rounding_of_normal(edge));
    }
  }
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    const double rounding = mesh.rounding_of_normal(contact.edge);
    for (const int point : mesh.edges[contact.edge]) freedom[point].hold_along(contact.direction, rounding);
    freedom[points + contact.edge].hold_along(contact.direction, rounding);
  }
  relax_displacement(discrete_, freedom, sweeps, points_, middles_, progress);
  if (beside_.base) return;
  CellBudget budget{kCellsOfGaps, &progress};
  for (const ContactEdge& contact : discrete_.clearance.edges)
    if (!follows_gap(contact)) lower_below(contact, budget);
}

std::optional<double> AdmissibleDisplacement::off_followed_gap(const ContactEdge& contact) const {
  const auto found = off_gap_.find(contact.edge);
  return found == off_gap_.end() ? std::nullopt : std::optional(found->second);
}

bool AdmissibleDisplacement::follows_gap(const ContactEdge& contact) const {
  return off_gap_.contains(contact.edge);
}

const Lift* AdmissibleDisplacement::lift(int edge) const {
  const auto found = lifts_.find(edge);
  return found == lifts_.end() ? nullptr : &found->second;
}

bool AdmissibleDisplacement::is_lifted(int t) const {
  return std::ranges::any_of(discrete_.mesh.triangle_edges[t],
                             [&](int edge) { return lift(edge) != nullptr; });
}

template <int D>
void AdmissibleDisplacement::add_lifts(int t, const Point& reference, const Eigen::Matrix2d& inverse_jacobian,
                                       Eigen::Matrix<double, D, 1>& value, Tensor<D>& slope) const {
  const Eigen::Vector3d hats(1 - reference.x() - reference.y(), reference.x(), reference.y());
  const Eigen::Matrix2d gradients = inverse_jacobian.transpose();
  const std::array<Vector, 3> hat_gradients{-gradients.rowwise().sum(), gradients.col(0), gradients.col(1)};
  for (int e = 0; e < 3; ++e) {
    const int edge = discrete_.mesh.triangle_edges[t][e];
    const Lift* lifted = lift(edge);
    if (!lifted) continue;
    int a = (e + 1) % 3, b = (e + 2) % 3;
    if (discrete_.mesh.triangles[t][a] != discrete_.mesh.edges[edge][0]) std::swap(a, b);
    value += lifted->value(hats[a], hats[b]);
    const Eigen::Matrix2Xd gradient =
        lifted->gradient(hats[a], hats[b], hat_gradients[a], hat_gradients[b]).transpose();
    slope += gradient.reshaped();
  }
}

template void AdmissibleDisplacement::add_lifts<1>(int, const Point&, const Eigen::Matrix2d&,
                                                   Eigen::Matrix<double, 1, 1>&, Tensor<1>&) const;
template void AdmissibleDisplacement::add_lifts<2>(int, const Point&, const Eigen::Matrix2d&,
                                                   Eigen::Matrix<double, 2, 1>&, Tensor<2>&) const;

Eigen::VectorXd AdmissibleDisplacement::on_edge(int edge, double s) const {
  const auto& [a, b] = discrete_.mesh.edges[edge];
  const Eigen::VectorXd quadratic = (1 - s) * (1 - 2 * s) * points_.col(a) +
                                    s * (2 * s - 1) * points_.col(b) + 4 * s * (1 - s) * middles_.col(edge);
  const Lift* lifted = lift(edge);
  return lifted ? Eigen::VectorXd(quadratic + (*lifted)(s)) : quadratic;
}

double AdmissibleDisplacement::along_contact(const ContactEdge& contact, double s) const {
  return direction(contact).dot(on_edge(contact.edge, s));
}

double AdmissibleDisplacement::room(const ContactEdge& contact, double s) const {
  return gap_at(contact, s) - along_contact(contact, s);
}

AdmissibleDisplacement::LiftRest AdmissibleDisplacement::rest_of_lifts(int t) const {
  LiftRest sum;
  for (const int edge : discrete_.mesh.triangle_edges[t]) {
    const auto found = rests_.find(edge);
    if (found == rests_.end()) continue;
    sum.value += found->second.value;
    sum.slope += found->second.slope;
  }
  return sum;
}

double AdmissibleDisplacement::largest_on(int t) const {
  return components_ == 1 ? bound_of_quadratic(on<1>(t)) : bound_of_quadratic(on<2>(t));
}

Eigen::VectorXd AdmissibleDisplacement::direction(const ContactEdge& contact) const {
  if (components_ == 1) return Eigen::VectorXd::Constant(1, -1);
  return contact.direction;
}

const Field& AdmissibleDisplacement::gap(const ContactEdge& contact) const {
  return gap_on(discrete_, contact);
}

/// Where the gap jumps in a node, that of this edge.
double AdmissibleDisplacement::gap_at(const ContactEdge& contact, double s) const {
  const Field& own = gap(contact);
  const EdgeLine line(discrete_.mesh, contact.edge);
  const double value = line.value(own, s);
  if (s > 0 && s < 1) return value;
  return values_at_end(own, line, s, kSmall * std::max(std::abs(value), scale_)).lower();
}

void AdmissibleDisplacement::refuse(const std::string& reason) {
  if (std::ranges::find(unmet_, reason) == unmet_.end()) unmet_.push_back(reason);
}

void AdmissibleDisplacement::refuse_point(int point) {
  refuse("no displacement meets all conditions at " + to_string(discrete_.mesh.points[point]));
}

/// The mean of v_h over each edge is that of m.
void AdmissibleDisplacement::set_middles(const Eigen::VectorXd& coupling, Progress& progress) {
  middles_.resize(components_, discrete_.mesh.edges.size());
  in_parts(discrete_.triangles(), progress,
           [&](Part part, Progress& own) { set_middles(coupling, part, own); });
}

/// Each edge by the first of its triangles.
void AdmissibleDisplacement::set_middles(const Eigen::VectorXd& coupling, Part part, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  const int per_edge = discrete_.spaces().traces_per_edge(), functions = per_edge / components_;
  for (int t = part.begin; t < part.end; ++t) {
    progress.check_in(t);
    const LocalVector traces = discrete_.traces.values(t, coupling);
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh.triangle_edges[t][e];
      if (mesh.edge_triangles[edge][0] != t) continue;
      Eigen::VectorXd mean = Eigen::VectorXd::Zero(components_);
      for (int j = 0; j < per_edge; j += components_)
        mean += traces.segment(e * per_edge + j, components_) / functions;
      const auto& [a, b] = mesh.edges[edge];
      middles_.col(edge) = (6 * mean - points_.col(a) - points_.col(b)) / 4;
    }
  }
}

void AdmissibleDisplacement::add_lift(int edge, const Values& d) {
  Lift lift(components_, d);
  if (lift.largest() > kSmall * scale_) lifts_.emplace(edge, std::move(lift));
}

}  // namespace signorini
