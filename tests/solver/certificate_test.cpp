#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "certify/admissible_displacement.hpp"
#include "certify/contact_pressure.hpp"
#include "certify/least_potential.hpp"
#include "certify/linear_balance.hpp"
#include "contact/active_set.hpp"
#include "contact/condense.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"
#include "norms.hpp"
#include "problems/membrane.hpp"
#include "summarize.hpp"
#include "system/hybrid_system.hpp"
#include "system/recovery.hpp"

namespace signorini {
namespace {

constexpr std::array schemes{Scheme::conforming, Scheme::nonconforming};

Solution solve_exactly(const Problem& problem) {
  return solve(problem, {ActiveSet{}, std::nullopt});
}

/// Gauss–Legendre on [0, 1].
struct GaussRule {
  static constexpr int size = 20;
  std::array<double, size> points, weights;

  GaussRule() {
    for (int i = 0; i < size; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (size + 0.5)), slope = 0;
      for (int step = 0; step < 8; ++step) {
        double before = 1, value = x;
        for (int k = 2; k <= size; ++k)
          before = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * before) / k);
        slope = size * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      points[i] = (1 + x) / 2;
      weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

const GaussRule gauss;

/// ∫ f ds from a to b; exact enough for half-integer powers of the distance from a too.
template <typename Function>
double integrate_from(const Point& a, const Point& b, const Function& f) {
  double sum = 0;
  for (int i = 0; i < GaussRule::size; ++i) {
    const double t = gauss.points[i], s = t * t;
    sum += gauss.weights[i] * 2 * t * f(s);
  }
  return sum * (b - a).norm();
}

/// ∫ f(reference point) over the reference triangle, from one of its corners; exact enough for half-integer
/// powers of the distance from the corner, and for functions that jump from ray to ray there.
template <typename Function>
double integrate_from(int corner, const Function& f) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  const Point &a = corners[corner], &b = corners[(corner + 1) % 3], &c = corners[(corner + 2) % 3];
  double sum = 0;
  for (int i = 0; i < GaussRule::size; ++i)
    for (int j = 0; j < GaussRule::size; ++j) {
      const double t = gauss.points[i], r = t * t, s = gauss.points[j];
      const Point far = (1 - s) * b + s * c;
      sum += gauss.weights[i] * gauss.weights[j] * 2 * t * r * f(Point(a + r * (far - a)));
    }
  return sum;
}

/// The certificate's fields for the signorini-edge, rebuilt from its ingredients: v, σ* and p*.
class EdgeFields {
 public:
  EdgeFields(const Problem& problem, const std::shared_ptr<const Mesh>& mesh)
      : discretization_(problem, *mesh), progress_(observer_, std::nullopt) {
    const HybridSystem system = assemble(discretization_, progress_);
    const Operator made(mesh, discretization_.clearance, system.matrix, false, progress_);
    CondensedContact condensed(made, system.right, progress_);
    const ContactResult found = active_set(condensed.contact(), {}, progress_);
    const Eigen::VectorXd x = condensed.traces(found.clearance, progress_);
    Recovered fields = recover(discretization_, x, progress_);
    solution_ =
        summarize(discretization_, {fields.stress, fields.displacement, found.clearance, x, found.outcome},
                  {ActiveSet{}, std::nullopt}, progress_);
    v_ = std::make_unique<AdmissibleDisplacement>(discretization_, solution_, x);
    v_->relax(x, progress_);
    const Eigen::VectorXd clearance = discretization_.clearance.clearance(found.clearance);
    pressure_ = std::make_unique<ContactPressure>(discretization_, solution_.stress, clearance);
    minimize_potential(discretization_, *v_, clearance, *pressure_, progress_);
  }

  const Mesh& mesh() const { return discretization_.mesh; }
  const ErrorBound& bound() const { return solution_.summary.error_bound.value(); }
  const std::vector<ContactEdge>& contact_edges() const { return discretization_.clearance.edges; }

  /// The corner of the triangle from which ∇v and ∇u are smooth: the singular point, or the one opposite a
  /// lifted edge.
  int corner_to_integrate_from(int t) const {
    for (int e = 0; e < 3; ++e) {
      const bool is_boundary = mesh().edge_triangles[mesh().triangle_edges[t][e]][1] < 0;
      if ((is_boundary && v_->is_lifted(t)) || mesh().corners(t)[e].norm() == 0) return e;
    }
    return 0;
  }

  /// σ_h.
  Vector stress(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    return discretization_.spaces().row.values(map, reference) * solution_.stress.col(t);
  }

  /// σ*.
  Vector admissible_stress(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    const Vector rise = map.jacobian.inverse().transpose() * (quadratic_gradients(reference) * potential(t));
    return stress(t, reference) + Vector(rise.y(), -rise.x());
  }

  Vector slope(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    Tensor<1> slope = inverse.transpose() * (quadratic_gradients(reference) * v_->on<1>(t).transpose());
    Eigen::Matrix<double, 1, 1> value = Eigen::Matrix<double, 1, 1>::Zero();
    v_->add_lifts<1>(t, reference, inverse, value, slope);
    return slope;
  }

  double pressure(int i, double s) const {
    return (1 - s) * pressure_->at_ends[i][0] + s * pressure_->at_ends[i][1];
  }
  double room(int i, double s) const { return v_->room(contact_edges()[i], s); }

 private:
  Eigen::Matrix<double, 6, 1> potential(int t) const {
    Eigen::Matrix<double, 6, 1> values = Eigen::Matrix<double, 6, 1>::Zero();
    const auto value = [](const std::unordered_map<int, double>& all, int key) {
      const auto found = all.find(key);
      return found == all.end() ? 0 : found->second;
    };
    for (int k = 0; k < 3; ++k) {
      values[k] = value(pressure_->potential_at_points, mesh().triangles[t][k]);
      values[3 + k] = value(pressure_->potential_at_middles, mesh().triangle_edges[t][k]);
    }
    return values;
  }

  Discretization discretization_;
  Observer observer_;
  Progress progress_;
  Solution solution_;
  std::unique_ptr<AdmissibleDisplacement> v_;
  std::unique_ptr<ContactPressure> pressure_;
};

/// The two sides of the identity of design.md, "The certificate", for σ*; and the left side for σ_h, of which
/// ‖σ − σ_h‖² is a part.
struct Sides {
  double left = 0, right = 0, of_solution = 0, stress_error = 0;
};

Sides sides_of(const EdgeFields& fields) {
  using Exact = problems::SignoriniEdge;
  const Mesh& mesh = fields.mesh();
  Sides sides;
  double of_stress = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const AffineMap map(mesh.corners(t));
    const auto integral = [&](const auto& f) {
      return map.determinant * integrate_from(fields.corner_to_integrate_from(t), f);
    };
    const double stress_error =
        integral([&](const Point& x) { return (Exact::stress(map(x)) - fields.stress(t, x)).squaredNorm(); });
    sides.stress_error += stress_error;
    of_stress += stress_error - integral([&](const Point& x) {
                   return (Exact::stress(map(x)) - fields.admissible_stress(t, x)).squaredNorm();
                 });
    sides.left += integral([&](const Point& x) {
      return (Exact::stress(map(x)) - fields.admissible_stress(t, x)).squaredNorm() +
             (Exact::stress(map(x)) - fields.slope(t, x)).squaredNorm();
    });
    sides.right += integral(
        [&](const Point& x) { return (fields.admissible_stress(t, x) - fields.slope(t, x)).squaredNorm(); });
  }
  for (int i = 0; i < static_cast<int>(fields.contact_edges().size()); ++i) {
    const auto& [first, second] = mesh.edges[fields.contact_edges()[i].edge];
    const Point a = mesh.points[first], b = mesh.points[second];
    // From the end that is closer to the singular point.
    const bool forward = a.norm() <= b.norm();
    const auto integral = [&](const auto& f) {
      return integrate_from(a, b, [&](double s) { return forward ? f(s) : f(1 - s); });
    };
    const auto x = [&](double s) { return a.x() + s * (b.x() - a.x()); };
    const auto gap_left = [&](double s) { return x(s) > 0 ? std::pow(x(s), 1.5) : 0; };
    const auto pressure = [&](double s) { return x(s) < 0 ? 1.5 * std::sqrt(-x(s)) : 0; };
    sides.left += 2 * integral([&](double s) { return fields.pressure(i, s) * gap_left(s); });
    sides.left += 2 * integral([&](double s) { return pressure(s) * fields.room(i, s); });
    sides.right += 2 * integral([&](double s) { return fields.pressure(i, s) * fields.room(i, s); });
  }
  sides.of_solution = sides.left + of_stress;
  return sides;
}

TEST(Certificate, HoldsTheIdentityOnAnExactSolution) {
  for (const Scheme scheme : schemes)
    for (const int n : {2, 6}) {
      const Problem problem = problems::SignoriniEdge::problem(scheme, n);
      const auto mesh = std::make_shared<const Mesh>(
          rectangle_mesh(std::get<Rectangle>(problem.domain), {2 * n, n}, Pattern::crossed));
      const EdgeFields fields(problem, mesh);
      const Sides sides = sides_of(fields);
      EXPECT_NEAR(sides.left, sides.right, 1e-10 * sides.right) << n;
      const double effectivity = fields.bound().value / std::sqrt(sides.of_solution);
      EXPECT_GE(effectivity, 1 - 1e-9);
      EXPECT_LE(effectivity, scheme == Scheme::conforming ? 1.25 : 1.001);
      EXPECT_LE(fields.bound().value / std::sqrt(sides.stress_error),
                scheme == Scheme::conforming ? 1.5 : 1.2);
      EXPECT_TRUE(fields.bound().guaranteed);
    }
}

TEST(Certificate, BoundsTheErrorOfThePapersProblem) {
  constexpr double energy = -0.914792950798;
  for (const Scheme scheme : schemes)
    for (const int n : {4, 8, 16, 32}) {
      const ErrorBound bound = solve_exactly(problems::paper(scheme, n)).summary.error_bound.value();
      EXPECT_TRUE(bound.guaranteed);
      EXPECT_LE(bound.energy_lower, energy);
      EXPECT_GE(bound.energy_upper, energy);
      // What both energies lack is half the square of the error.
      EXPECT_LE(std::sqrt(2 * (bound.energy_upper - bound.energy_lower)), bound.value * (1 + 1e-9));
    }
}

/// v is so much better than the stress of this scheme that hardly anything of the bound is its own error.
TEST(Certificate, OfTheNonconformingSchemeIsTheErrorOfItsStress) {
  constexpr double energy = -0.914792950798;
  for (const int n : {32, 64}) {
    const ErrorBound bound =
        solve_exactly(problems::paper(Scheme::nonconforming, n)).summary.error_bound.value();
    EXPECT_GE(std::sqrt(2 * (energy - bound.energy_lower)), 0.98 * bound.value) << n;
  }
}

/// ‖σ − σ_f‖_C of two solutions, the finer one on the mesh refined so many times.
double distance(const Problem& problem, const Solution& coarse, const Solution& fine, int refinements) {
  const RaviartThomas &element = spaces_of(coarse.scheme, 1).row, &finer = spaces_of(fine.scheme, 1).row;
  return std::sqrt(integrate(fine, [&](int t, const AffineMap& map, const Point& reference) {
    const int parent = t >> (2 * refinements);
    const AffineMap parent_map(coarse.mesh.corners(parent));
    const Point x = map(reference);
    const Point there = parent_map.jacobian.inverse() * (x - coarse.mesh.corners(parent)[0]);
    const Vector difference = finer.values(map, reference) * fine.stress.col(t) -
                              element.values(parent_map, there) * coarse.stress.col(parent);
    const auto compliance = compliance_at(problem.material, x);
    return difference.dot(compliance * difference);
  }));
}

TEST(Certificate, BoundsTheErrorOfFiftyRandomProblems) {
  std::vector<double> effectivities;
  for (unsigned seed = 0; seed < 50; ++seed) {
    Problem problem = problems::random(seed);
    const auto& divisions = std::get<Divisions>(problem.mesh.fineness);
    problem.mesh.fineness = Divisions{divisions.x / 2, divisions.y / 2};
    const Solution coarse = solve_exactly(problem);
    const ErrorBound bound = coarse.summary.error_bound.value();
    problem.scheme = Scheme::conforming;
    problem.mesh.refine = 2;
    const Solution fine = solve_exactly(problem);
    const ErrorBound fine_bound = fine.summary.error_bound.value();

    const double energy = (fine_bound.energy_lower + fine_bound.energy_upper) / 2;
    EXPECT_LT(fine_bound.value, 0.6 * bound.value) << seed;
    EXPECT_LE(bound.energy_lower, energy) << seed;
    EXPECT_GE(bound.energy_upper, energy) << seed;
    const double error = distance(problem, coarse, fine, 2);
    EXPECT_LE(error - fine_bound.value, bound.value) << seed;
    if (!bound.guaranteed) {
      EXPECT_FALSE(bound.unmet.empty());
      continue;
    }
    effectivities.push_back(bound.value / std::sqrt(error * error + 2 * (bound.energy_upper - energy)));
  }
  // On meshes so coarse some boundary values are not resolved.
  ASSERT_GE(effectivities.size(), 45u);
  std::ranges::sort(effectivities);
  EXPECT_LE(effectivities[effectivities.size() / 2], 1.2);
  EXPECT_LE(effectivities.back(), 1.85);
}

TEST(LinearBalance, HasWhatTheStressLacksOfTheLinearPartsOfLoadAndTraction) {
  const auto f = [](const Point& x) { return 1 + 2 * x.x() - 3 * x.y(); };
  const auto t = [](const Point& x) { return 0.5 - 4 * x.x() + x.y(); };
  Problem problem;
  problem.mesh = {Divisions{3, 2}, Pattern::crossed};
  problem.body = problems::function(f);
  problem.boundary = {{"left", Fixed{}},
                      {"right", Traction{problems::function(t)}},
                      {"top", Traction{problems::function(t)}}};
  const Mesh mesh = rectangle_mesh(std::get<Rectangle>(problem.domain), {3, 2}, Pattern::crossed);
  const Discretization discretization(problem, mesh);
  const LinearBalance balance(discretization);
  const TractionField traction(problem, mesh);
  const RaviartThomas element(1);
  LoadValues<1> load(discretization);
  for (int triangle = 0; triangle < discretization.triangles(); ++triangle) {
    const LinearBalance::Coefficients tau = balance(triangle, load).value();
    const AffineMap map(mesh.corners(triangle));
    for (const Point& x : {Point(0, 0), Point(1, 0), Point(0, 1), Point(0.2, 0.3)})
      EXPECT_NEAR(element.reference_divergences(x).dot(tau) / map.determinant,
                  f(mesh.centroid(triangle)) - f(map(x)), 1e-12);
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh.triangle_edges[triangle][e];
      const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
      const Point &a = corners[(e + 1) % 3], &b = corners[(e + 2) % 3];
      const Vector along = map(b) - map(a), outward = Vector(along.y(), -along.x()).normalized();
      for (const double s : {0., 0.3, 1.}) {
        const Point x = a + s * (b - a);
        const double lacking = traction.acts_on(edge) ? t(map(x)) - t((map(a) + map(b)) / 2) : 0;
        EXPECT_NEAR(outward.dot(element.values(map, x) * tau), lacking, 1e-12);
      }
    }
  }
}

TEST(Certificate, OfAMembraneDoesNotDependOnUnits) {
  for (const Scheme scheme : schemes) {
    const double plain = solve_exactly(problems::paper(scheme, 16)).summary.error_bound.value().relative;
    for (const auto& [length, modulus] : {std::pair(1e9, 1e-9), {1e-9, 1e9}, {1e-9, 1e-9}}) {
      Problem problem = problems::paper(scheme, 16);
      problem.domain = Rectangle{{0, 0}, {length, length}};
      problem.material = MembraneStiffness{Field(modulus), Field(0), Field(modulus)};
      problem.body =
          problems::function([middle = length / 2](const Point& x) { return x.x() < middle ? 10. : -10.; });
      const ErrorBound bound = solve_exactly(problem).summary.error_bound.value();
      EXPECT_TRUE(bound.guaranteed);
      EXPECT_NEAR(bound.relative, plain, 1e-9 * plain);
    }
  }
}

TEST(Certificate, SharesTheBoundOutToTheTriangles) {
  for (const Scheme scheme : schemes) {
    const Solution solution = solve_exactly(problems::SignoriniEdge::problem(scheme, 8));
    const ErrorBound::Parts& parts = solution.summary.error_bound.value().parts;
    ASSERT_EQ(solution.error_squares.size(), solution.summary.triangles);
    EXPECT_GE(solution.error_squares.minCoeff(), 0);
    const double sum = parts.constitutive * parts.constitutive + parts.contact * parts.contact +
                       parts.oscillation * parts.oscillation + parts.equilibration * parts.equilibration;
    EXPECT_NEAR(solution.error_squares.sum(), sum, 1e-12 * sum);
  }
}

}  // namespace
}  // namespace signorini
