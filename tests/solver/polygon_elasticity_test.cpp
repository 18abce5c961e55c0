// Elasticity on unstructured meshes: patch test, orders of convergence, locking, turned materials.
#include <gtest/gtest.h>

#include "methods_agree.hpp"
#include "norms.hpp"
#include "problems/elasticity.hpp"
#include "problems/sanitized.hpp"

namespace signorini::polygon_elasticity_test {
namespace {

/// The points turned by an angle about the origin.
std::vector<Point> turned(std::vector<Point> points, double angle) {
  Eigen::Matrix2d turn;
  turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  for (Point& point : points) point = turn * point;
  return points;
}

Polygon turned_block(double angle) {
  return {turned({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, angle), {}, {"bottom", "right", "top", "left"}};
}

/// (σ_xx, σ_yy, σ_xy) of −p e eᵀ for the direction e that was y.
Eigen::Vector3d pressed_along_turned_y(double p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {-p * s * s, -p * c * c, p * s * c};
}

struct TurnedCase {
  Scheme scheme;
  double poisson;
  double angle;
};

class TurnedPatch : public testing::TestWithParam<TurnedCase> {};

TEST_P(TurnedPatch, OnAnUnstructuredMesh) {
  const auto [scheme, poisson, angle] = GetParam();
  Problem problem = problems::pressed_block(scheme, Pattern::right, poisson, 0);
  problem.domain = turned_block(angle);
  problem.mesh.fineness = LargestEdge{0.3};
  problem.boundary["top"] = Pressure{0.7};
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  const Eigen::Vector3d stress = pressed_along_turned_y(0.7, angle);
  constexpr double tolerance = 1e-11;
  for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
    ASSERT_LT((solution.stress_at_centroids.col(t) - stress).norm(), 0.7 * tolerance);
  EXPECT_NEAR(solution.summary.contact.force / 1.4, 1, tolerance);
}

std::vector<TurnedCase> turned_cases() {
  std::vector<TurnedCase> all;
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double poisson : {0.3, 0.4999, 0.499999})
      for (const double angle : {0., std::numbers::pi / 6}) all.push_back({scheme, poisson, angle});
  return all;
}

INSTANTIATE_TEST_SUITE_P(Cases, TurnedPatch, testing::ValuesIn(turned_cases()));

/// A pentagon, refined uniformly from one unstructured mesh; mixed conditions, the exact solution as data.
Problem pentagon(const problems::Smooth& smooth, Scheme scheme, int refine) {
  Problem problem = smooth.problem(scheme, 1);
  problem.domain =
      Polygon{{{0, 0}, {0.9, 0.1}, {1.1, 0.7}, {0.5, 1.1}, {-0.1, 0.6}}, {}, {"a", "b", "c", "d", "e"}};
  problem.mesh.fineness = LargestEdge{0.4};
  problem.mesh.refine = refine;
  const Condition fixed = problem.boundary.at("left"), traction = problem.boundary.at("right");
  problem.boundary = {{"a", fixed}, {"b", traction}, {"c", traction}, {"d", fixed}, {"e", fixed}};
  return problem;
}

double stress_error_on(const problems::Smooth& smooth, const Problem& problem) {
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  const RaviartThomas& row = spaces_of(problem.scheme, 2).row;
  return std::sqrt(integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
    const Eigen::Matrix2d found =
        (row.values(map, x) * solution.stress.col(t).reshaped(2, row.size()).transpose()).transpose();
    return (found - smooth.stress(map(x))).squaredNorm();
  }));
}

void expect_rate_on_pentagon(Scheme scheme, double at_least) {
  std::vector<double> last;
  for (const double poisson : {0.3, 0.49999}) {
    const problems::Smooth smooth(poisson);
    std::vector<double> errors;
    for (const int refine : {0, 1, 2, 3})
      errors.push_back(stress_error_on(smooth, pentagon(smooth, scheme, refine)));
    std::printf("nu %.5f: stress rate %.3f\n", poisson, rate(errors));
    EXPECT_GE(rate(errors), at_least) << poisson;
    last.push_back(errors.back());
  }
  EXPECT_LT(last[1] / last[0], 2);
}

TEST(Pentagon, NonconformingRate) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  expect_rate_on_pentagon(Scheme::nonconforming, 0.95);
}
TEST(Pentagon, ConformingRate) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  expect_rate_on_pentagon(Scheme::conforming, 1.9);
}

/// A random star-shaped polygon, every other one with a hole, fixed at one side. Sides that do not touch that
/// one are contacts with gaps of either sign, or pulled.
Problem random_polygon(unsigned seed) {
  std::mt19937 engine(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(engine);
  };
  Problem problem;
  problem.scheme = seed % 2 ? Scheme::conforming : Scheme::nonconforming;
  const int corners = 5 + static_cast<int>(seed % 4);
  Polygon polygon;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * (k + number(-0.3, 0.3)) / corners;
    polygon.vertices.push_back(number(0.6, 1.2) * Point(std::cos(angle), std::sin(angle)));
  }
  if (seed / 2 % 2) polygon.holes = {turned({{-0.15, -0.1}, {0.15, -0.1}, {0, 0.2}}, number(0, 6))};
  problem.domain = polygon;
  problem.mesh.fineness = LargestEdge{0.2};
  const double young = number(1, 5), slope = number(-0.5, 0.5);
  if (seed % 3 == 0)
    problem.material = problems::orthotropic(number(0, 3));
  else
    problem.material =
        YoungPoisson{problems::function([=](const Point& x) { return young * std::exp(slope * x.x()); }),
                     Field(number(0, 0.49)), seed % 3 == 1 ? Plane::strain : Plane::stress};
  problem.body = VectorField(Field(number(-0.3, 0.3)), Field(number(-0.3, 0.3)));
  problem.boundary["side0"] = Fixed{};
  for (int k = 2; k + 1 < corners; ++k) {
    const double gap = number(-0.02, 0.05), wave = number(0, 0.03), pull = number(-0.1, 0.1);
    const auto wavy = [=](const Point& x) { return gap + wave * std::sin(9 * x.x() + 5 * x.y()); };
    Condition& condition = problem.boundary["side" + std::to_string(k)];
    if (k % 2 == 0)
      condition = Contact{problems::function(wavy)};
    else
      condition = Traction{VectorField(Field(pull), Field(-2 * pull))};
  }
  return problem;
}

TEST(RandomPolygons, MethodsAgree) {
  int partly_open = 0;
  for (unsigned seed = 1; seed <= (sanitized ? 4 : 20); ++seed) {
    SCOPED_TRACE(seed);
    const Solution solution = expect_methods_agree(random_polygon(seed));
    int open = 0, closed = 0;
    for (const ContactPart& part : solution.contact)
      for (const bool is_open : part.open) ++(is_open ? open : closed);
    partly_open += open > 0 && closed > 0;
  }
  EXPECT_GE(partly_open, sanitized ? 3 : 15);  // the problems are what they are meant to be
}

/// A cantilever pressed down on a foundation below its tip.
Solution cantilever(Scheme scheme, double poisson, int refine) {
  Problem problem = problems::block(scheme, Pattern::alternating, 100, poisson);
  problem.domain = Rectangle{{0, 0}, {5, 1}};
  problem.mesh.fineness = Divisions{20, 4};
  problem.mesh.refine = refine;
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{0.05}}, {"top", Traction{VectorField(0, -0.1)}}};
  return solve(problem, {ActiveSet{}, {}});
}

/// The same on triangles that shrink towards the corners of the clamp, whose singularity is stronger near ν =
/// 1/2 and would decide every error on even meshes.
Summary graded_cantilever(Scheme scheme, double poisson, int refine) {
  Problem problem = problems::block(scheme, Pattern::right, 100, poisson);
  problem.domain = Polygon{{{0, 0}, {5, 0}, {5, 1}, {0, 1}}, {}, {"bottom", "right", "top", "left"}};
  problem.mesh = {LargestEdge{0.25}};
  problem.mesh.refine = refine;
  for (const double y : {0., 1.})
    for (const double size : {0.1, 0.03, 0.01, 0.003, 0.001})
      problem.mesh.sizes.push_back({{0, y}, 4 * size, size});
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{0.05}}, {"top", Traction{VectorField(0, -0.1)}}};
  return solve(problem, {ActiveSet{}, {}}).summary;
}

/// At equal mesh, the errors of the contact force on two meshes of both schemes, against the conforming one
/// on a finer mesh; of the nonconforming scheme also those of the energy. The conforming energy is no
/// measure: it meets the fine one to 1e-6 on the coarsest mesh and changes sides.
TEST(Cantilever, DoesNotLockOnGradedMeshes) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  constexpr std::array ratios{0.3, 0.49999};
  std::array<Summary, 2> fine;
  for (int i = 0; i < 2; ++i) fine[i] = graded_cantilever(Scheme::conforming, ratios[i], 3);
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const int refine : {0, 1}) {
      std::array<double, 2> force, energy;
      for (int i = 0; i < 2; ++i) {
        const Summary found = graded_cantilever(scheme, ratios[i], refine);
        force[i] = std::abs(found.contact.force / fine[i].contact.force - 1);
        energy[i] = std::abs(found.energy / fine[i].energy - 1);
      }
      std::printf("relative errors, force %.2e %.2e, energy %.2e %.2e\n", force[0], force[1], energy[0],
                  energy[1]);
      EXPECT_LT(force[1] / force[0], 1.5);
      if (scheme == Scheme::nonconforming) {
        EXPECT_LT(energy[1] / energy[0], 1.5);
      }
    }
}

/// The errors of the energy at equal mesh. On finer ones the singular corners of the clamp, which are
/// stronger near ν = 1/2, decide the conforming error.
TEST(Cantilever, DoesNotLock) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    std::vector<double> errors;
    for (const double poisson : {0.3, 0.49999}) {
      const double exact = cantilever(Scheme::conforming, poisson, 2).summary.energy;
      errors.push_back(std::abs(cantilever(scheme, poisson, 0).summary.energy / exact - 1));
    }
    std::printf("relative energy errors %.3e %.3e\n", errors[0], errors[1]);
    EXPECT_LT(errors[1] / errors[0], 1.5);
  }
}

/// The clamp ends where the open contact begins: its singular reaction is no contact force.
TEST(Cantilever, TheClampIsNoContact) {
  const Solution coarse = cantilever(Scheme::conforming, 0.3, 0),
                 fine = cantilever(Scheme::conforming, 0.3, 2);
  EXPECT_NEAR(coarse.summary.contact.force / fine.summary.contact.force, 1, 2e-3);
  EXPECT_TRUE(coarse.contact[0].open[0]);
  EXPECT_EQ(coarse.contact[0].pressure[0], 0);
}

/// An orthotropic block on a foundation, everything turned together: material, domain and load.
Problem turned_orthotropic(Scheme scheme, double angle) {
  Problem problem = problems::block(scheme, Pattern::right, 1, 0.3);
  // A mesh of the client's own, so that both have the same triangles.
  problem.domain =
      MeshData{turned({{0, 0}, {2, 0}, {2, 1}, {0, 1}, {0.9, 0.4}}, angle),
               {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
               {{"bottom", {{0, 1}}}, {"right", {{1, 2}}}, {"top", {{2, 3}}}, {"left", {{3, 0}}}}};
  problem.mesh.refine = 3;
  problem.material = problems::orthotropic(angle);
  const Vector pull = turned({{0.3, -0.5}}, angle)[0];
  problem.boundary = {
      {"left", Fixed{}}, {"bottom", Contact{0.02}}, {"top", Traction{VectorField(pull.x(), pull.y())}}};
  return problem;
}

TEST(Orthotropic, ATurnedBlockIsTheSameBlock) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Solution straight = solve(turned_orthotropic(scheme, 0), {ActiveSet{}, {}});
    const Solution turned = solve(turned_orthotropic(scheme, 0.5), {ActiveSet{}, {}});
    EXPECT_NEAR(turned.summary.energy / straight.summary.energy, 1, 1e-11);
    EXPECT_GT(straight.summary.contact.force, 0);
    ASSERT_EQ(turned.contact[0].open, straight.contact[0].open);
    for (std::size_t i = 0; i < straight.contact[0].points.size(); ++i) {
      EXPECT_NEAR(turned.contact[0].pressure[i], straight.contact[0].pressure[i], 1e-10);
      EXPECT_NEAR(turned.contact[0].clearance[i], straight.contact[0].clearance[i], 1e-11);
    }
  }
}

}  // namespace
}  // namespace signorini::polygon_elasticity_test
