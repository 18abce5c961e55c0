// Lemmas 5 and 6: a stress that carries what is not known of the loads.

#include "certify/data/carried_loads.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "certify/data/linear_remainder.hpp"
#include "certify/elasticity/johnson_mercier.hpp"
#include "certify/membrane/quadratic_balance.hpp"
#include "fem/cubature.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"
#include "no_pressure.hpp"
#include "problems/elasticity.hpp"

namespace signorini::carried_loads_test {
namespace {

/// ν of the lemma.
double norm_of_element(int components) {
  Eigen::MatrixXd rows;
  if (components == 1) {
    const FineTriangleRule& rule = fine_triangle_rule();
    rows.resize(2 * FineTriangleRule::size, QuadraticBalance::kData);
    for (int q = 0; q < FineTriangleRule::size; ++q)
      rows.middleRows<2>(2 * q) =
          std::sqrt(rule.weights[q]) * QuadraticBalance::reference_values(rule.points[q]);
  } else {
    const std::vector<JohnsonMercier::Place> places = JohnsonMercier::places(rule_of_degree(8));
    rows.resize(3 * static_cast<Eigen::Index>(places.size()), JohnsonMercier::kData);
    for (std::size_t q = 0; q < places.size(); ++q)
      for (int k = 0; k < JohnsonMercier::kData; ++k)
        rows.block<3, 1>(3 * static_cast<Eigen::Index>(q), k) =
            std::sqrt(places[q].weight) *
            Eigen::Vector3d(1, 1, std::sqrt(2.))
                .cwiseProduct(JohnsonMercier::stress(places[q], johnson_mercier().from_data.col(k)));
  }
  return Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues()[0];
}

/// A membrane or an elastic body that is a unit square of two triangles or of so many columns of two, and all
/// that the lemma asks.
class Square {
 public:
  Square(int components, const std::map<std::string, Condition>& boundary, int columns = 1)
      : mesh_(rectangle_mesh(Rectangle{}, {columns, 1}, Pattern::right)) {
    problem_.mesh = {Divisions{columns, 1}, Pattern::right};
    problem_.scheme = Scheme::nonconforming;
    problem_.material = components == 1 ? Material(MembraneStiffness{Field(2), Field(0), Field(0.5)})
                                        : Material(YoungPoisson{Field(2), Field(0.3), Plane::strain});
    softest_ = components == 1 ? 2 : 1.3 / 2;
    problem_.boundary = boundary;
    discretization_.emplace(problem_, mesh_);
    laws_.emplace(problem_.material, mesh_, 1e-6, progress_);
    pressure.emplace(no_pressure(*discretization_));
  }

  CarriedLoads carry(const std::vector<double>& forces) const {
    return carry_uncertain_loads(*discretization_, *laws_, *pressure, {0, forces});
  }

  double carry_by_motions(const UncertainLoads& loads) {
    return carried_by_motions(*discretization_, *laws_, loads, std::nullopt, progress_);
  }

  const Mesh& mesh() const { return mesh_; }
  int contact_edge(int i) const { return discretization_->clearance.edges[i].edge; }
  int components() const { return discretization_->spaces().components; }

  /// a_T² for data z with this square, of the elastic body brought to the reference triangle by |J⁻¹|: with
  /// det J = 1 that is |J|, of which all triangles have the same.
  double square(double of_data) const {
    const double j = AffineMap(mesh_.corners(0)).jacobian.squaredNorm();
    return softest_ * (components() == 1 ? j : j * j * j) * std::pow(norm_of_element(components()), 2) *
           of_data;
  }

  std::optional<ContactPressure> pressure;

 private:
  Problem problem_;
  Mesh mesh_;
  double softest_;
  std::optional<Discretization> discretization_;
  Observer observer_;
  Progress progress_{observer_, std::nullopt};
  std::optional<LawOnMesh> laws_;
};

/// The projection of a load with ∫ |q| = F may be 9 F / |T| = 18 F at six nodes.
double of_load(double force) {
  return 6 * std::pow(18 * force, 2);
}

/// A linear traction with a force and a moment, at the three nodes of an edge of length 1.
double of_traction(double force, double moment) {
  return 2 * std::pow(force + 6 * moment, 2) + force * force;
}

/// Each triangle passes its load on to an edge of its own, the body its moment too: the right angle is √½
/// away from the middle of the longest edge, and no corner is nearer to a middle that it does not lie on.
TEST(CarriedLoads, CountTheLoadOfEachTriangle) {
  for (const int components : {1, 2}) {
    const Square square(components,
                        {{"left", Fixed{}}, {"right", Fixed{}}, {"bottom", Fixed{}}, {"top", Fixed{}}});
    const double one = square.carry({3, 0}).norm, other = square.carry({0, 4}).norm,
                 both = square.carry({3, 4}).norm;
    const double moment = components == 1 ? 0 : std::sqrt(0.5);
    EXPECT_GE(one * one, square.square(of_load(3) + of_traction(3, 3 * moment)));
    EXPECT_LE(one * one, 10 * square.square(of_load(3) + of_traction(3, 3 * moment)));
    EXPECT_NEAR(other, one * 4 / 3, 1e-12 * other);
    EXPECT_NEAR(both, one * 5 / 3, 1e-12 * both);
    const UncertainLoads loads = square.carry({3, 4}).loads;
    EXPECT_EQ(loads.on_triangles, (std::vector<double>{3, 4}));
  }
}

/// A load that has to go through a neighbour stresses it too: it comes in over one edge, and leaves over the
/// other. Where two loads may meet in a triangle each counts twice.
TEST(CarriedLoads, CountTheWayToTheFixedPart) {
  for (const int components : {1, 2}) {
    const Square square(components, {{"bottom", Fixed{}}});
    const auto& parts = square.mesh().boundary;
    const auto bottom = std::ranges::find(parts, std::string("bottom"), &BoundaryPart::name);
    const int near = square.mesh().edge_triangles[bottom->edges[0]][0];
    std::vector<double> forces(2);
    forces[1 - near] = 1;
    const double norm = square.carry(forces).norm, moment = components == 1 ? 0 : std::sqrt(0.5);
    const double least = square.square(2 * of_load(1) + 3 * of_traction(1, moment));
    EXPECT_GE(norm * norm, least * (1 - 1e-12));
    EXPECT_LE(norm * norm, (components == 1 ? 1 + 1e-12 : 10) * least);
    // Further away it has a larger moment.
    forces = {0, 0};
    forces[near] = 1;
    EXPECT_GT(norm, square.carry(forces).norm);
  }
}

/// A lack has a force and a moment, on the edge where it acts and on the way from there.
TEST(CarriedLoads, CountWhatThePressureLacks) {
  for (const int components : {1, 2}) {
    Square square(components, {{"left", Fixed{}}, {"bottom", Contact{Field(1)}}});
    const int edge = square.contact_edge(0), t = square.mesh().edge_triangles[edge][0];
    EXPECT_EQ(square.carry({}).norm, 0);
    square.pressure->lacks.push_back({edge, 2, 0.3});
    const CarriedLoads carried = square.carry({});
    EXPECT_GE(carried.norm * carried.norm, square.square(of_traction(2, 0.3) + of_traction(2, 0)));
    // A linear φ has ∫ q φ ≤ (F + 2 M / |e|) max |φ|.
    EXPECT_GE(carried.loads.on_edges[t][square.mesh().local_edge(t, edge)], 2 + 2 * 0.3);
  }
}

/// Without a fixed part a rigid motion ρ in p* (1 + ρ·d) takes the resultant F: here ρ·d = F / ∫ p*.
TEST(CarriedLoads, ChangeThePressureThatHasToTakeThem) {
  for (const int components : {1, 2}) {
    std::map<std::string, Condition> boundary{{"bottom", Contact{Field(1)}}};
    if (components == 2) boundary["left"] = Roller{};
    Square square(components, boundary, 2);
    for (auto& ends : square.pressure->at_ends) ends = {7, 7};
    const CarriedLoads carried = square.carry({0.001, 0.002, 0, 0});
    EXPECT_TRUE(carried.is_held);
    EXPECT_TRUE(carried.root.has_value());
    EXPECT_GE(carried.change_of_pressure, 0.003 / 7);
    EXPECT_LE(carried.change_of_pressure, 1);
    double taken = 0;
    for (const int i : {0, 1}) {
      const int edge = square.contact_edge(i), t = square.mesh().edge_triangles[edge][0];
      taken += carried.loads.on_edges[t][square.mesh().local_edge(t, edge)];
    }
    EXPECT_GE(taken, 0.003);
    EXPECT_FALSE(square.carry({4, 4, 0, 0}).is_held);  // more than the pressure has
  }
}

/// A traction of a membrane that is not known but for ∫ |q| ≤ F may act as a linear one with the force F and
/// the moment F |e| / 2: √21 F at the three nodes of the edge, and no norm is smaller.
TEST(CarriedLoads, CountTheMomentsOfATractionOfAMembrane) {
  Problem problem = problems::paper(Scheme::nonconforming, 1);
  problem.boundary = {{"left", Fixed{}},
                      {"right", Fixed{}},
                      {"bottom", Fixed{}},
                      {"top", Traction{VectorField(problems::formula("sin(40 * x)"))}}};
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Mesh mesh = rectangle_mesh(Rectangle{}, {1, 1}, Pattern::right);
  const Discretization discretization(problem, mesh);
  const LawOnMesh laws(problem.material, mesh, 1e-6, progress);
  double square = 0, forces = 0;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge)
    if (discretization.traction.acts_on(edge)) {
      const double force = discretization.traction[edge].uncertain_force;
      EXPECT_GT(force, 0);
      square += 21 * force * force;
      forces += force;
    }
  const double of_shape = std::sqrt(2.);  // |J| / √det J of the two triangles, at least
  const CarriedLoads carried = carry_uncertain_loads(discretization, laws, no_pressure(discretization));
  EXPECT_GE(carried.norm, norm_of_element(1) * of_shape * std::sqrt(square));
  double on_edges = 0;
  for (const auto& own : carried.loads.on_edges) on_edges += own[0] + own[1] + own[2];
  EXPECT_DOUBLE_EQ(on_edges, forces);
}

/// On a patch of a triangle cut in four: what each part's load is off by stresses the part, and acts on the
/// whole as a force.
TEST(LoadsBroughtBack, HaveTheForceOfAllParts) {
  Problem problem = problems::paper(Scheme::conforming, 1);
  problem.body = problems::formula("(x - 0.45)^2 + (y - 0.55)^2 < 0.083 ? 10 : -10");
  const Mesh mesh = refine(rectangle_mesh(Rectangle{}, {1, 1}, Pattern::right), 1);
  const Discretization parts(problem, mesh);
  Observer observer;
  Progress progress(observer, std::nullopt);
  const LawOnMesh laws(problem.material, mesh, 1e-6, progress);
  const std::vector<int> parents{0, 0, 0, 0, 1, 1, 1, 1};
  const LoadsBroughtBack back = bring_back(parts, laws, no_pressure(parts), parents, 2);
  std::vector<double> forces(2);
  double of_loads = 0;
  for (int t = 0; t < parts.triangles(); ++t) {
    forces[parents[t]] += parts.body[t].uncertain_force;
    of_loads += of_load(parts.body[t].uncertain_force);
  }
  for (const int parent : {0, 1}) {
    EXPECT_GT(forces[parent], 0);
    EXPECT_DOUBLE_EQ(back.forces[parent], forces[parent]);
  }
  problem.body = VectorField(0);
  const Mesh triangles = rectangle_mesh(Rectangle{}, {1, 1}, Pattern::right);
  const Discretization whole(problem, triangles);
  const CarriedLoads carried = carry_uncertain_loads(
      whole, LawOnMesh(problem.material, triangles, 1e-6, progress), no_pressure(whole), back);
  EXPECT_EQ(carried.loads.on_triangles, back.forces);
  EXPECT_GT(carried.norm, 0);
  EXPECT_EQ(carried.norm_on_patches, std::sqrt(back.square));
  // |J|² / det J = 2 of all parts, and the law is 1.
  EXPECT_GE(back.square, 2 * std::pow(norm_of_element(1), 2) * of_loads);
}

/// Lemma 6 with a constant of a membrane on each of two triangles, of which only the first is loaded: on
/// itself, and by a traction on its outer edge that is not fixed. μ is then found by hand.
TEST(CarriedByMotions, IsTheFormulaOfTheLemma) {
  Square square(1, {{"left", Fixed{}}, {"bottom", Fixed{}}, {"right", Fixed{}}});
  const Mesh& mesh = square.mesh();
  const auto fixed = [&](int edge) {
    return std::ranges::any_of(mesh.boundary, [&](const BoundaryPart& part) {
      return part.name != "top" && std::ranges::count(part.edges, edge) > 0;
    });
  };
  const auto inside = [&](int edge) { return mesh.edge_triangles[edge][1] >= 0; };
  const int top = std::ranges::find(mesh.boundary, std::string("top"), &BoundaryPart::name)->edges[0],
            loaded = mesh.edge_triangles[top][0];
  constexpr double softest = 2, force = 3, on_edge = 5;
  std::array<MotionRemainder, 2> remainders;
  std::array<double, 2> counted{};
  for (const int t : {0, 1}) {
    remainders[t] = motion_remainder<1>(mesh.corners(t));
    for (const int edge : mesh.triangle_edges[t]) counted[t] += inside(edge) || fixed(edge);
  }
  Eigen::Matrix2d left = Eigen::Matrix2d::Zero();
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (!inside(edge) && !fixed(edge)) continue;
    double weight = 0;
    Eigen::Vector2d difference = Eigen::Vector2d::Zero();
    for (const int t : mesh.edge_triangles[edge]) {
      if (t < 0) continue;
      weight += counted[t] * softest * std::pow(remainders[t].on_edges[mesh.local_edge(t, edge)], 2);
      difference[t] = difference.isZero() ? 1 : -1;
    }
    left += mesh.length(edge) / weight * difference * difference.transpose();
  }
  UncertainLoads loads(mesh);
  loads.on_triangles[loaded] = force;
  loads.on_edges[loaded][mesh.local_edge(loaded, top)] = on_edge;
  const double mu = 1 / left.inverse()(loaded, loaded) / (force + on_edge);
  const MotionRemainder& own = remainders[loaded];
  const double beyond = std::sqrt(softest) * (3 * force * own.on_triangle / std::sqrt(0.5) +
                                              2 * on_edge * own.on_edges[mesh.local_edge(loaded, top)]);
  const double said = square.carry_by_motions(loads), of_motions = std::sqrt((force + on_edge) / mu);
  EXPECT_GE(said, of_motions + beyond);
  EXPECT_LE(said, 1.1 * of_motions + beyond);
}

}  // namespace
}  // namespace signorini::carried_loads_test
