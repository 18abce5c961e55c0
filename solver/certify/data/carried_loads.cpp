#include "certify/data/carried_loads.hpp"

#include <cmath>

#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "certify/membrane/quadratic_balance.hpp"
#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

/// The norm of the map from the data of an element to the L2 norm of the stress on the reference triangle.
double norm_of(const Eigen::MatrixXd& rows) {
  return std::sqrt(eigenvalues(rows.transpose() * rows).maxCoeff());
}

double norm_of_membrane_element() {
  static const double norm = [] {
    const FineTriangleRule& rule = fine_triangle_rule();
    Eigen::MatrixXd rows(2 * FineTriangleRule::size, QuadraticBalance::kData);
    for (int q = 0; q < FineTriangleRule::size; ++q)
      rows.middleRows<2>(2 * q) =
          std::sqrt(rule.weights[q]) * QuadraticBalance::reference_values(rule.points[q]);
    return norm_of(rows);
  }();
  return norm;
}

double norm_of_macro_element() {
  static const double norm = [] {
    const std::vector<JohnsonMercier::Place> places = JohnsonMercier::places(rule_of_degree(6));
    Eigen::MatrixXd rows(3 * places.size(), JohnsonMercier::kData);
    for (std::size_t q = 0; q < places.size(); ++q)
      for (int k = 0; k < JohnsonMercier::kData; ++k) {
        Eigen::Vector3d stress = JohnsonMercier::stress(places[q], johnson_mercier().from_data.col(k));
        stress[2] *= std::sqrt(2.);
        rows.block<3, 1>(3 * q, k) = std::sqrt(places[q].weight) * stress;
      }
    return norm_of(rows);
  }();
  return norm;
}

/// A force of at most this size with a moment of at most this size about the middle of the edge or the
/// triangle.
struct Action {
  double force = 0, moment = 0;

  /// About a place that is no further away.
  void add(const Action& other, double distance) {
    force += other.force;
    moment += other.moment + other.force * distance;
  }
};

class Carrier {
 public:
  Carrier(const Discretization& discrete, const LawOnMesh& laws, const ContactPressure& pressure)
      : discrete_(discrete),
        mesh_(discrete.mesh),
        extent_(std::sqrt(mesh_.area())),
        laws_(laws),
        pressure_(pressure),
        way_out_(mesh_.triangles.size(), -1),
        loads_(mesh_),
        squares_of_loads_(Eigen::VectorXd::Zero(discrete.triangles())),
        on_edges_(Eigen::Matrix3Xd::Zero(3, discrete.triangles())) {}

  CarriedLoads run(const LoadsBroughtBack& of_patches) {
    const std::vector<double>& forces = of_patches.forces;
    std::vector<Action> into(mesh_.triangles.size());
    CarriedLoads carried{.loads = UncertainLoads(mesh_), .norm_on_patches = std::sqrt(of_patches.square)};
    for (int t = 0; t < discrete_.triangles(); ++t) {
      if (!forces.empty()) add_load(t, forces[t], into[t]);
      carried.are_of_data = !start(t, into[t]) || carried.are_of_data;
    }
    if (!carried.are_of_data && pressure_.lacks.empty()) return carried;
    for (const ContactPressure::Lack& lack : pressure_.lacks) act(lack.edge, {lack.force, lack.moment}, into);
    std::vector<int> order = from_fixed_parts();
    if (order.empty()) {
      order = from_a_root();
      carried.root = order.front();
      carried.change_of_pressure = change_pressure(into);
    }
    carried.loads = loads_;
    carried.is_held = order.size() == mesh_.triangles.size() && carried.change_of_pressure <= 1;
    if (!carried.is_held) return carried;
    double square = 0;
    for (auto t = order.rbegin(); t != order.rend(); ++t) {
      if (into[*t].force == 0 && into[*t].moment == 0) continue;
      if (way_out_[*t] >= 0) pass_on(*t, into);
      square += square_on(*t);
    }
    carried.norm = std::sqrt(square);
    return carried;
  }

  LoadsBroughtBack bring_back(const std::vector<int>& parents, int triangles) {
    LoadsBroughtBack back;
    back.forces.resize(triangles);
    std::vector<double> areas(triangles);
    std::vector<Action> into(mesh_.triangles.size());
    for (int t = 0; t < discrete_.triangles(); ++t) {
      start(t, into[t]);
      back.forces[parents[t]] += into[t].force;
      areas[parents[t]] += area(t);
    }
    // What is brought back acts against the constant load that stands for it.
    for (int t = 0; t < discrete_.triangles(); ++t)
      add_load(t, back.forces[parents[t]] * area(t) / areas[parents[t]], into[t]);
    std::vector<int> order;
    for (int root = 0; root < discrete_.triangles(); ++root) {
      if (seen_[root]) continue;
      std::size_t next = order.size();
      reach(root, -1, order);
      for (; next < order.size(); ++next)
        for (const int edge : mesh_.triangle_edges[order[next]])
          for (const int t : mesh_.edge_triangles[edge])
            if (t >= 0 && parents[t] == parents[root]) reach(t, edge, order);
    }
    for (auto t = order.rbegin(); t != order.rend(); ++t) {
      if (into[*t].force == 0) continue;
      if (way_out_[*t] >= 0) pass_on(*t, into);
      back.square += square_on(*t);
    }
    return back;
  }

 private:
  double area(int t) const { return AffineMap(mesh_.corners(t)).determinant / 2; }

  /// A traction on an edge of the boundary.
  void act(int edge, const Action& action, std::vector<Action>& into) {
    const int t = mesh_.edge_triangles[edge][0];
    add_edge(t, edge, action);
    loads_.on_edges[t][mesh_.local_edge(t, edge)] += action.force + 2 * action.moment / mesh_.length(edge);
    into[t].add(action, size(t));
  }

  /// The rigid motions of a body, in units of its size, along a direction; the deflection of a membrane.
  Eigen::VectorXd motions_along(const Point& x, const Vector& d) const {
    if (discrete_.spaces().components == 1) return Eigen::VectorXd::Constant(1, 1);
    const Vector r = (x - mesh_.points[0]) / extent_;
    return Eigen::Vector3d(d.x(), d.y(), d.y() * r.x() - d.x() * r.y());
  }

  /// Lets the tractions on Γ_C and on rollers take the resultant: answers max |r·d|, more than 1 if they do
  /// not.
  double change_pressure(std::vector<Action>& into) {
    struct Side {
      int edge;
      Vector direction;
      double force;  ///< ∫ p*, or ∫ W
    };
    std::vector<Side> sides;
    double total = 0, length = 0;
    for (std::size_t i = 0; i < pressure_.at_ends.size(); ++i) {
      const ContactEdge& contact = discrete_.clearance.edges[i];
      const double of_edge = mesh_.length(contact.edge),
                   force = of_edge * (pressure_.at_ends[i][0] + pressure_.at_ends[i][1]) / 2;
      if (force == 0 || pressure_.steep.contains(contact.edge)) continue;
      sides.push_back({contact.edge, contact.direction, force});
      total += force;
      length += of_edge;
    }
    const std::size_t contacts = sides.size();
    for (const BoundaryPart& part : mesh_.boundary)
      if (condition_on<Roller>(discrete_.problem, part.name))
        for (const int edge : part.edges)
          sides.push_back(
              {edge, mesh_.outward_normal(edge), length > 0 ? total / length * mesh_.length(edge) : 0});

    const Eigen::Index motions = motions_along(Point(0, 0), Vector(0, 1)).size();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(motions, motions);
    // ∫ p* a² ≥ ½ ∫ p* · a(middle)² for all linear p* ≥ 0 and linear a.
    for (const Side& side : sides) {
      const Eigen::VectorXd own = motions_along(middle(side.edge), side.direction);
      matrix += side.force / 2 * own * own.transpose();
    }
    const double least = eigenvalues(matrix)[0];
    double resultant = 0;
    for (int t = 0; t < discrete_.triangles(); ++t) {
      const double distance = (mesh_.centroid(t) - mesh_.points[0]).norm() + size(t);
      resultant += 2 * into[t].force + (into[t].moment + into[t].force * distance) / extent_;
    }
    if (!(least > 0)) return 2;
    const double of_motion = resultant / least;
    double change = 0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      const double own = of_motion * (motions_along(middle(sides[i].edge), sides[i].direction).norm() +
                                      mesh_.length(sides[i].edge) / extent_);
      if (i < contacts) change = std::max(change, own);
      act(sides[i].edge, {own * sides[i].force, own * sides[i].force * mesh_.length(sides[i].edge) / 2},
          into);
    }
    return change;
  }

  Point middle(int edge) const {
    return (mesh_.points[mesh_.edges[edge][0]] + mesh_.points[mesh_.edges[edge][1]]) / 2;
  }

  double size(int t) const {
    double most = 0;
    for (const int edge : mesh_.triangle_edges[t]) most = std::max(most, mesh_.length(edge));
    return most;
  }

  /// The unknown parts of the load on the triangle and of the traction on its edges, as data of the element.
  /// Returns whether there are none.
  bool start(int t, Action& into) {
    const double h = size(t);
    add_load(t, discrete_.body[t].uncertain_force, into);
    for (const int edge : mesh_.triangle_edges[t]) {
      if (!discrete_.traction.acts_on(edge)) continue;
      const double of_edge = discrete_.traction[edge].uncertain_force;
      if (of_edge == 0) continue;
      add_edge(t, edge, {of_edge, of_edge * mesh_.length(edge) / 2});
      loads_.on_edges[t][mesh_.local_edge(t, edge)] += of_edge;
      into.add({of_edge, of_edge * mesh_.length(edge) / 2}, h);
    }
    return into.force == 0;
  }

  /// A load on the triangle with ∫ |q| at most `force`, as data of the element.
  void add_load(int t, double force, Action& into) {
    if (force == 0) return;
    const AffineMap map(mesh_.corners(t));
    into.add({force, 0}, size(t));
    loads_.on_triangles[t] += force;
    // The projection onto P1 of a load with ∫ |q| = F is nowhere larger than 9 F / area; six nodes.
    const double at_node = map.determinant * to_reference(map) * 18 * force / map.determinant;
    squares_of_loads_[t] += 2 * 6 * at_node * at_node;  // two loads at most: (a + b)² ≤ 2 (a² + b²)
  }

  /// |J⁻¹| for an elastic body, whose rows are transformed too.
  double to_reference(const AffineMap& map) const {
    return discrete_.spaces().components == 1 ? 1 : map.jacobian.inverse().norm();
  }

  /// A linear traction on the edge with the force and the moment, at three nodes. Several add up.
  void add_edge(int t, int edge, const Action& action) {
    const AffineMap map(mesh_.corners(t));
    on_edges_(mesh_.local_edge(t, edge), t) +=
        to_reference(map) * (action.force + 6 * action.moment / mesh_.length(edge));
  }

  /// Breadth first, so that ways are short.
  std::vector<int> from_fixed_parts() {
    std::vector<int> order;
    for (const BoundaryPart& part : mesh_.boundary)
      if (condition_on<Fixed>(discrete_.problem, part.name))
        for (const int edge : part.edges) reach(mesh_.edge_triangles[edge][0], edge, order);
    return grown(std::move(order));
  }

  std::vector<int> from_a_root() {
    std::vector<int> order;
    reach(0, -1, order);
    return grown(std::move(order));
  }

  void reach(int t, int edge, std::vector<int>& order) {
    if (t < 0 || seen_[t]) return;
    seen_[t] = true;
    way_out_[t] = edge;
    order.push_back(t);
  }

  std::vector<int> grown(std::vector<int> order) {
    for (std::size_t i = 0; i < order.size(); ++i)
      for (const int edge : mesh_.triangle_edges[order[i]])
        for (const int t : mesh_.edge_triangles[edge]) reach(t, edge, order);
    return order;
  }

  /// A membrane has no moments to pass on: its traction there is constant.
  void pass_on(int t, std::vector<Action>& into) {
    const int edge = way_out_[t];
    if (discrete_.spaces().components == 1) into[t].moment = 0;
    add_edge(t, edge, into[t]);
    const auto& [one, other] = mesh_.edge_triangles[edge];
    const int next = one == t ? other : one;
    if (next < 0) return;
    add_edge(next, edge, into[t]);
    into[next].add(into[t], size(next));
  }

  /// a_T².
  double square_on(int t) const {
    const AffineMap map(mesh_.corners(t));
    const double j = map.jacobian.squaredNorm(),
                 squares_of_data = squares_of_loads_[t] + 3 * on_edges_.col(t).squaredNorm();
    return discrete_.spaces().components == 1 ? laws_.whole(t).softest * j / map.determinant *
                                                    std::pow(norm_of_membrane_element(), 2) * squares_of_data
                                              : laws_.whole(t).softest * j * j / map.determinant *
                                                    std::pow(norm_of_macro_element(), 2) * squares_of_data;
  }

  const Discretization& discrete_;
  const Mesh& mesh_;
  const double extent_;  ///< the root of the area
  const LawOnMesh& laws_;
  const ContactPressure& pressure_;
  std::vector<int> way_out_;  ///< of each triangle the edge towards Γ_D
  std::vector<bool> seen_ = std::vector<bool>(mesh_.triangles.size(), false);
  UncertainLoads loads_;
  Eigen::VectorXd squares_of_loads_;
  Eigen::Matrix3Xd on_edges_;  ///< at each node of the three edges of a triangle
};

}  // namespace

CarriedLoads carry_uncertain_loads(const Discretization& discrete, const LawOnMesh& laws,
                                   const ContactPressure& pressure, const LoadsBroughtBack& of_patches) {
  return Carrier(discrete, laws, pressure).run(of_patches);
}

LoadsBroughtBack bring_back(const Discretization& patch, const LawOnMesh& laws,
                            const ContactPressure& pressure, const std::vector<int>& parents, int triangles) {
  return Carrier(patch, laws, pressure).bring_back(parents, triangles);
}

}  // namespace signorini
