#include <gtest/gtest.h>

#include <random>

#include <Eigen/LU>

#include "certify/displacement/lift.hpp"
#include "certify/elasticity/airy_minimization.hpp"
#include "certify/elasticity/edge_tractions.hpp"
#include "certify/elasticity/johnson_mercier.hpp"
#include "certify/elasticity/traction_relaxation.hpp"
#include "certify/local_fields.hpp"
#include "fem/lagrange.hpp"
#include "problems/elasticity.hpp"
#include "problems/families.hpp"
#include "solved_problem.hpp"

namespace signorini::certify_parts_test {
namespace {

class Parts : public testing::TestWithParam<Scheme> {};

/// On Γ_C the traction is −p* d with p* ≥ 0.
void expect_pressure(const SolvedProblem& made, const EdgeTractions& tractions,
                     const ContactPressure& pressure) {
  const Mesh& mesh = *made.solution.mesh;
  for (std::size_t i = 0; i < pressure.at_ends.size(); ++i) {
    const ContactEdge& contact = made.discretization.clearance.edges[i];
    const int t = mesh.edge_triangles[contact.edge][0], e = mesh.local_edge(t, contact.edge);
    Eigen::Matrix<double, 2, 3> own = tractions.on(t, e);
    if (mesh.triangles[t][(e + 1) % 3] != mesh.edges[contact.edge][0]) own.col(0).swap(own.col(1));
    const auto [p, q] = pressure.at_ends[i];
    EXPECT_GE(std::min(p, q), 0);
    const double rounding = 1e-10 * made.solution.stress.cwiseAbs().maxCoeff() / mesh.length(contact.edge);
    EXPECT_LE((own.col(0) + p * contact.direction).norm(), rounding);
    EXPECT_LE((own.col(1) + q * contact.direction).norm(), rounding);
  }
}

/// Every triangle is in balance of forces and of moments, and has the traction given on Γ_F.
void expect_balance(const SolvedProblem& made, const ContactPressure& pressure,
                    const EdgeTractions& tractions) {
  EXPECT_TRUE(tractions.unmet().empty());
  expect_pressure(made, tractions, pressure);
  const Mesh& mesh = *made.solution.mesh;
  for (int t = 0; t < made.discretization.triangles(); ++t) {
    const auto corners = mesh.corners(t);
    const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
    const auto cross = [](const Vector& x, const Vector& y) { return x.x() * y.y() - x.y() * y.x(); };
    Vector force = Vector::Zero();
    double moment = 0, size = 0;
    const AffineMap map(corners);
    for (int q = 0; q < TriangleRule::size; ++q) {
      const Point x = map(triangle_rule().points[q]);
      const Vector f = triangle_rule().weights[q] * map.determinant *
                       Vector(made.problem.body(0, x), made.problem.body(1, x));
      force += f;
      moment += cross(x - centroid, f);
    }
    for (int e = 0; e < 3; ++e) {
      const Vector a = corners[(e + 1) % 3] - centroid, b = corners[(e + 2) % 3] - centroid;
      const Eigen::Matrix<double, 2, 3> own = tractions.on(t, e);
      const double length = (b - a).norm();
      // Simpson's rule is exact for cubic functions.
      force += length / 6 * (own.col(0) + 4 * own.col(2) + own.col(1));
      moment +=
          length / 6 * (cross(a, own.col(0)) + 4 * cross((a + b) / 2, own.col(2)) + cross(b, own.col(1)));
      size += length * own.norm();
      const int edge = mesh.triangle_edges[t][e];
      const TractionField given(made.problem, mesh);
      if (!given.acts_on(edge)) continue;
      const bool forward = mesh.triangles[t][(e + 1) % 3] == mesh.edges[edge][0];
      for (const auto& [column, s] : {std::pair(0, 0.), {1, 1.}, {2, 0.5}})
        for (int c = 0; c < 2; ++c)
          EXPECT_NEAR(own(c, column), given(edge, c, forward ? s : 1 - s), 1e-10 * own.norm());
    }
    EXPECT_LE(force.norm(), 1e-10 * size);
    EXPECT_LE(std::abs(moment), 1e-10 * size * (corners[1] - corners[0]).norm());
  }
}

/// The same before and after the tractions are relaxed.
void expect_balance(const SolvedProblem& made, const ContactPressure& pressure) {
  EdgeTractions tractions(made.discretization, made.solution.stress, pressure, made.progress);
  expect_balance(made, pressure, tractions);
  relax_tractions(made.discretization, made.solution.stress, tractions, 2, made.progress);
  expect_balance(made, pressure, tractions);
}

TEST_P(Parts, EveryTriangleIsInBalanceOfForcesAndMoments) {
  const Problem problem = punch(GetParam());
  const SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
  ContactPressure pressure(made.discretization, made.solution.stress, made.clearance);
  EXPECT_TRUE(pressure.lacks.empty());
  expect_balance(made, pressure);
  if (GetParam() == Scheme::nonconforming) return;
  minimize_airy(made.discretization, made.solution.stress, made.displacement(), made.clearance, pressure,
                made.progress);
  expect_balance(made, pressure);
}

/// Each edge of the polygon has a normal of its own.
TEST(Parts, OfContactThatBendsAreInBalance) {
  for (const bool is_round : {true, false}) {
    Problem problem = problems::half_disc(Scheme::conforming);
    if (!is_round) {
      problem.domain =
          Polygon{{{0, 0}, {1, -0.1}, {2, 0}, {2, 1}, {0, 1}}, {}, {"arc", "arc", "side", "top", "side"}};
      problem.boundary["arc"] = Contact{problems::formula("0.015 * x")};
    }
    const SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
    ContactPressure pressure(made.discretization, made.solution.stress, made.clearance);
    EXPECT_TRUE(pressure.lacks.empty());
    const auto largest = [](const auto& ends) {
      double most = 0;
      for (const auto& [p, q] : ends) most = std::max({most, std::abs(p), std::abs(q)});
      return most;
    };
    EXPECT_GT(largest(pressure.changes), 0.01 * largest(pressure.at_ends));
    expect_balance(made, pressure);
    const auto before = pressure.at_ends;
    minimize_airy(made.discretization, made.solution.stress, made.displacement(), made.clearance, pressure,
                  made.progress);
    EXPECT_NE(pressure.at_ends, before);
    expect_balance(made, pressure);
  }
}

/// p* is nowhere negative, and has force and moment of p_h.
void expect_admissible(const SolvedProblem& made, const ContactPressure& pressure) {
  double force = 0, change = 0, moment_of_change = 0;
  for (std::size_t i = 0; i < pressure.at_ends.size(); ++i) {
    const int edge = made.discretization.clearance.edges[i].edge;
    const auto& [a, b] = made.solution.mesh->edges[edge];
    const double length = made.solution.mesh->length(edge);
    const double x = made.solution.mesh->points[a].x(), y = made.solution.mesh->points[b].x();
    const auto [p, q] = pressure.at_ends[i];
    const auto [dp, dq] = pressure.changes[i];
    EXPECT_GE(std::min(p, q), 0);
    force += length * (p + q) / 2;
    change += length * (dp + dq) / 2;
    moment_of_change += length * (2 * x * dp + x * dq + y * dp + 2 * y * dq) / 6;
  }
  EXPECT_NEAR(force, made.solution.summary.contact.force, 1e-10 * force);
  EXPECT_NEAR(change, 0, 1e-10 * force);
  EXPECT_NEAR(moment_of_change, 0, 1e-10 * force);
}

TEST_P(Parts, ThePressureIsNowhereNegativeAndHasTheForceOfTheDiscreteOne) {
  const Problem problem = punch(GetParam());
  const SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
  ContactPressure pressure(made.discretization, made.solution.stress, made.clearance);
  expect_admissible(made, pressure);
  if (GetParam() == Scheme::nonconforming) return;
  const auto before = pressure.at_ends;
  minimize_airy(made.discretization, made.solution.stress, made.displacement(), made.clearance, pressure,
                made.progress);
  EXPECT_NE(pressure.at_ends, before);
  expect_admissible(made, pressure);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Parts, testing::Values(Scheme::conforming, Scheme::nonconforming));

TEST(AdmissibleDisplacement, MeetsEveryConditionAtEveryPoint) {
  Problem problem;
  problem.mesh = {Divisions{5, 5}, Pattern::alternating};
  const auto fixed = [](const Point& x, const Vector&) {
    return 0.3 * std::exp(x.y()) * std::sin(2 * x.y());
  };
  const auto gap = [](const Point& x, const Vector&) { return 0.05 * std::cos(7 * x.x()); };
  problem.body = VectorField(-8);
  problem.boundary = {{"left", Fixed{problems::formula("0.3 * exp(y) * sin(2*y)")}},
                      {"bottom", Contact{problems::formula("0.05 * cos(7*x)")}}};
  problem.boundary["right"] = Fixed{VectorField(1)};
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    problem.scheme = scheme;
    const SolvedProblem made(problem, solve(problem, {ActiveSet{}, {}}));
    const AdmissibleDisplacement v = made.displacement();
    EXPECT_TRUE(v.unmet().empty());
    for (const BoundaryPart& part : made.solution.mesh->boundary)
      for (const int edge : part.edges)
        for (const double s : {0., 0.1, 0.37, 0.5, 0.83, 1.}) {
          const auto& [a, b] = made.solution.mesh->edges[edge];
          const Point x = made.solution.mesh->points[a] +
                          s * (made.solution.mesh->points[b] - made.solution.mesh->points[a]);
          const double value = v.on_edge(edge, s)[0];
          if (part.name == "left") {
            EXPECT_NEAR(value, fixed(x, {}), 1e-9);
          }
          if (part.name == "right") {
            EXPECT_NEAR(value, 1, 1e-12);
          }
          // u ≥ −g for the membrane.
          if (part.name == "bottom") {
            EXPECT_GE(value, -gap(x, {}) - 1e-9);
          }
        }
  }
}

/// τ n for τ = (xx, yy, xy).
Vector traction(const Eigen::Vector3d& stress, const Vector& n) {
  return {stress[0] * n.x() + stress[2] * n.y(), stress[2] * n.x() + stress[1] * n.y()};
}

using JohnsonMercierData = Eigen::Matrix<double, JohnsonMercier::kData, 1>;

/// The work of tractions and divergence on w = (1, 0) and w = (0, 1) at a node: ∮ t·w − ∫ div·w.
Vector work_of(const JohnsonMercierData& data, int node) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  Vector work = Vector::Zero();
  for (int e = 0; e < 3 && node < 6; ++e)
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const Point x = (1 - s) * corners[(e + 1) % 3] + s * corners[(e + 2) % 3];
      work += edge_rule().weights[q] * quadratic_basis(x)[node] *
              (data.segment<6>(6 * e).reshaped(2, 3) * edge_basis(2, s));
    }
  for (const JohnsonMercier::Place& place : JohnsonMercier::places(rule_of_degree(6)))
    work -= place.weight * place.displacement_basis[node] *
            (data.tail<12>().reshaped(2, 6) * quadratic_basis(place.point));
  return work;
}

/// The forces and the moment of the data.
Eigen::Vector3d resultants(const JohnsonMercierData& data) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int node = 0; node < JohnsonMercier::kNodes; ++node) {
    const Vector work = work_of(data, node);
    const Point x = JohnsonMercier::node(node);
    sum += Eigen::Vector3d(work.x(), work.y(), x.x() * work.y() - x.y() * work.x());
  }
  return sum;
}

/// Any tractions and divergence that balance.
JohnsonMercierData balanced_data() {
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  JohnsonMercierData data;
  for (double& entry : data) entry = unit(generator);
  Eigen::Matrix<double, JohnsonMercier::kData, 3> rigid = decltype(rigid)::Zero();
  Eigen::Matrix3d of_rigid;
  for (int k = 0; k < 3; ++k) {
    for (int z = 0; z < 6; ++z) {
      const Point x = JohnsonMercier::node(z);
      rigid.col(k).segment<2>(JohnsonMercier::kTractions + 2 * z) =
          k < 2 ? Vector(k == 0, k == 1) : Vector(-x.y(), x.x());
    }
    of_rigid.col(k) = resultants(rigid.col(k));
  }
  return data - rigid * of_rigid.inverse() * resultants(data);
}

/// By parts, a stress does the work of its tractions and its divergence on every displacement.
TEST(JohnsonMercier, HasTheTractionsAndTheDivergenceThatItIsGiven) {
  const JohnsonMercierData data = balanced_data();
  const JohnsonMercier& element = johnson_mercier();
  const auto work_of_stress = [](const auto& coefficients, int node) {
    Vector work = Vector::Zero();
    for (const JohnsonMercier::Place& place : JohnsonMercier::places(rule_of_degree(6)))
      work += place.weight *
              traction(JohnsonMercier::stress(place, coefficients), place.displacement_gradients.col(node));
    return work;
  };
  const Eigen::Matrix<double, JohnsonMercier::kStresses, 1> stress = element.from_data * data;
  for (int node = 0; node < JohnsonMercier::kNodes; ++node) {
    EXPECT_LE((work_of_stress(stress, node) - work_of(data, node)).norm(), 1e-12);
    for (int k = 0; k < JohnsonMercier::kFree; ++k)
      EXPECT_LE(work_of_stress(element.free.col(k), node).norm(), 1e-12);
  }
}

TEST(Lift, VanishesOnTheOtherEdgesAndHasItsOwnGradient) {
  const Lift lift(1, [](double s) -> Eigen::VectorXd {
    return Eigen::VectorXd::Constant(1, std::sin(3 * s) * s * (1 - s));
  });
  EXPECT_NEAR(lift.value(0.3, 0.7)[0], std::sin(2.1) * 0.21, 1e-6);
  EXPECT_NEAR(lift.value(0.4, 0)[0], 0, 1e-14);
  EXPECT_NEAR(lift.value(0, 0.4)[0], 0, 1e-14);
  constexpr double step = 1e-6;
  const auto gradient = lift.gradient(0.3, 0.4, Vector(1, 0), Vector(0, 1));
  EXPECT_NEAR(gradient(0, 0), (lift.value(0.3 + step, 0.4)[0] - lift.value(0.3 - step, 0.4)[0]) / (2 * step),
              1e-8);
  EXPECT_NEAR(gradient(0, 1), (lift.value(0.3, 0.4 + step)[0] - lift.value(0.3, 0.4 - step)[0]) / (2 * step),
              1e-8);
}

/// The error of the interpolant of s⁹, whose ninth coefficient is 1, is ω itself.
/// The error for s⁹ is the product of the distances from the nodes: its slope, and what it is over the
/// bubble, are largest at the ends.
TEST(Lift, IsOffByNoMoreThanItSays) {
  const auto d = [](double s) { return std::pow(s, 9) - s; };
  const Lift lift(1, [&](double s) -> Eigen::VectorXd { return Eigen::VectorXd::Constant(1, d(s)); });
  const auto error = [&](double s) { return d(s) - lift(s)[0]; };
  const Lift::Errors& errors = Lift::errors();
  double value = 0, slope = 0, over_bubble = 0;
  constexpr double step = 1e-6;
  for (int i = 0; i <= 2000; ++i) {
    const double s = std::clamp(i / 2000., step, 1 - step);
    value = std::max(value, std::abs(error(s)));
    over_bubble = std::max(over_bubble, std::abs(error(s)) / (4 * s * (1 - s)));
    slope = std::max(slope, std::abs(error(s + step) - error(s - step)) / (2 * step));
  }
  for (const auto& [seen, said] :
       {std::pair(value, errors.value), {slope, errors.slope}, {over_bubble, errors.over_bubble}}) {
    EXPECT_LE(seen, said);
    EXPECT_GE(seen, 0.99 * said);
  }
}

TEST(NearestAdmissible, LiesOnOneConstraintOrInTheCorner) {
  const Vector x(1, 0), y(0, 1);
  EXPECT_EQ(*nearest_admissible(Vector(0.5, 0.5), {{x, 1, false}, {y, 1, false}}, 1), Vector(0.5, 0.5));
  EXPECT_LE((*nearest_admissible(Vector(2, 0.5), {{x, 1, false}, {y, 1, false}}, 1) - Vector(1, 0.5)).norm(),
            1e-14);
  EXPECT_LE((*nearest_admissible(Vector(2, 3), {{x, 1, false}, {y, 1, false}}, 1) - Vector(1, 1)).norm(),
            1e-14);
  EXPECT_LE((*nearest_admissible(Vector(0, 0), {{x, 1, true}, {y, 1, false}}, 1) - Vector(1, 0)).norm(),
            1e-14);
  EXPECT_FALSE(nearest_admissible(Vector(0, 0), {{x, 1, true}, {x, 0.5, false}}, 1));
}

}  // namespace
}  // namespace signorini::certify_parts_test
