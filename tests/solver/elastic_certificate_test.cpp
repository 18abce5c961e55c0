#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <tuple>

#include <Eigen/LU>

#include "norms.hpp"
#include "problems/elasticity.hpp"
#include "problems/sanitized.hpp"
#include "solve.hpp"

namespace signorini::elastic_certificate_test {
namespace {

Solution solved(const Problem& problem) {
  return solve(problem, {ActiveSet{}, {}});
}

/// ‖σ − σ_h‖_C for an exact stress.
template <typename Stress>
double energy_error(const Solution& solution, const Material& material, const Stress& exact) {
  const RaviartThomas& element = spaces_of(solution.scheme, 2).row;
  return std::sqrt(integrate(solution, [&](int t, const AffineMap& map, const Point& x) {
    const auto rows = solution.stress.col(t).reshaped(2, element.size());
    const Eigen::Matrix2d rest = (element.values(map, x) * rows.transpose()).transpose() - exact(map(x));
    const Eigen::Vector4d row_by_row = rest.transpose().reshaped();
    return row_by_row.dot(compliance_at(material, map(x)) * row_by_row);
  }));
}

/// The smooth solution: what the bound is, relative to the left side of the identity. The energy of the exact
/// solution, which the left side needs, is ½ ‖σ‖²_C − (f, u) − <t, u> by a fine mesh.
struct Smooth {
  Smooth(Scheme scheme, double poisson, int n) : exact(poisson), problem(exact.problem(scheme, n)) {
    const Solution solution = solved(problem);
    bound = *solution.summary.error_bound;
    stress_error = energy_error(solution, problem.material, [&](const Point& x) { return exact.stress(x); });
  }

  double left_side(double energy) const {
    return std::sqrt(stress_error * stress_error + 2 * (bound.energy_upper - energy));
  }

  problems::Smooth exact;
  Problem problem;
  ErrorBound bound;
  double stress_error;
};

using BodyCase = std::tuple<Scheme, double>;
class SmoothBody : public testing::TestWithParam<BodyCase> {};

/// Its load and its traction vary within the triangles, and have couples there.
TEST_P(SmoothBody, IsBoundedWhateverPoissonsRatio) {
  const auto [scheme, poisson] = GetParam();
  const Smooth fine(Scheme::conforming, poisson, 48);
  const double energy = (fine.bound.energy_lower + fine.bound.energy_upper) / 2;
  for (const int n : {8, 16, 24}) {
    const Smooth smooth(scheme, poisson, n);
    EXPECT_TRUE(smooth.bound.guaranteed);
    EXPECT_LE(smooth.bound.energy_lower, energy);
    EXPECT_GE(smooth.bound.energy_upper, energy);
    const double left_side = smooth.left_side(energy);
    EXPECT_GE(smooth.bound.value, left_side);
    EXPECT_LE(smooth.bound.value, 1.5 * left_side) << "n = " << n;
    EXPECT_LE(smooth.bound.parts.oscillation, 0.03 * left_side) << "n = " << n;
  }
}

INSTANTIATE_TEST_SUITE_P(Poisson, SmoothBody,
                         testing::Combine(testing::Values(Scheme::conforming, Scheme::nonconforming),
                                          testing::ValuesIn(sanitized
                                                                ? std::vector{0.4999}
                                                                : std::vector{0.1, 0.3, 0.49, 0.4999})));

/// ‖σ − σ_f‖_C of two solutions, the finer one on the mesh refined so many times.
double distance(const Problem& problem, const Solution& coarse, const Solution& fine, int refinements) {
  const RaviartThomas &element = spaces_of(coarse.scheme, 2).row, &finer = spaces_of(fine.scheme, 2).row;
  const auto stress = [](const RaviartThomas& rows, const AffineMap& map, const Point& x,
                         const auto& column) {
    const Eigen::Matrix2d by_columns = rows.values(map, x) * column.reshaped(2, rows.size()).transpose();
    return Eigen::Vector4d(by_columns.reshaped());
  };
  return std::sqrt(integrate(fine, [&](int t, const AffineMap& map, const Point& reference) {
    const int parent = t >> (2 * refinements);
    const AffineMap around(coarse.mesh->corners(parent));
    const Point there = around.jacobian.inverse() * (map(reference) - around.origin);
    const Eigen::Vector4d rest = stress(finer, map, reference, fine.stress.col(t)) -
                                 stress(element, around, there, coarse.stress.col(parent));
    return rest.dot(compliance_at(problem.material, map(reference)) * rest);
  }));
}

/// A block pressed on one half and lifted on the other, and a half-disc that is lowered on a plane: where
/// contact ends, the pressure of the conforming scheme is far from admissible.
Problem lifted_block(Scheme scheme) {
  Problem problem = problems::block(scheme, Pattern::crossed, 3, 0.3);
  problem.mesh.fineness = Divisions{12, 6};
  const Field pull = problems::formula("x < 1 ? -1 : 0.1");
  problem.boundary = {{"left", Roller{}}, {"bottom", Contact{}}, {"top", Traction{VectorField(0, pull)}}};
  return problem;
}
Problem lowered_disc(Scheme scheme) {
  return problems::half_disc(scheme);
}
Problem disc_lowered_along_y(Scheme scheme) {
  Problem problem = problems::half_disc(scheme);
  problem.boundary["arc"] = Contact{problems::formula("y"), Vector(0, -1)};
  return problem;
}

class ContactEnds : public testing::TestWithParam<BodyCase> {};

TEST_P(ContactEnds, AreBoundedCloseToTheError) {
  const auto& [scheme, poisson] = GetParam();
  for (const auto make : {&lifted_block, &lowered_disc, &disc_lowered_along_y}) {
    Problem problem = make(Scheme::conforming);
    problem.material = YoungPoisson{Field(1), Field(poisson), Plane::strain};
    problem.mesh.refine = 2;
    const Solution fine = solved(problem);
    const double energy = energy_by(*fine.summary.error_bound);
    problem.scheme = scheme;
    problem.mesh.refine = 0;
    const Solution coarse = solved(problem);
    const ErrorBound bound = *coarse.summary.error_bound;
    EXPECT_TRUE(bound.guaranteed);
    EXPECT_LE(bound.energy_lower, energy);
    EXPECT_GE(bound.energy_upper, energy);
    const double left = left_side(distance(problem, coarse, fine, 2), coarse, fine, energy);
    EXPECT_GE(bound.value, left);
    EXPECT_LE(bound.value, 1.5 * left);
  }
}

/// On 32 × 32 squares a load that jumps along a line that no mesh has, or along a circle.
TEST_P(ContactEnds, WithAJumpThroughTheBodyAreBoundedCloseToTheError) {
  const auto& [scheme, poisson] = GetParam();
  const bool along_a_circle = poisson == 0.3;
  Problem problem;
  const int n = sanitized ? 8 : 32;
  problem.mesh.fineness = Divisions{n, n};
  problem.material = YoungPoisson{Field(1), Field(poisson), Plane::strain};
  problem.body = VectorField(
      Field(0), problems::formula(along_a_circle ? "(x - 0.45)^2 + (y - 0.55)^2 < 0.083 ? -1 : 0.5"
                                                 : "x + 0.7*y < 0.61 ? -1 : 0.5"));
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{0.02}}};
  problem.scheme = Scheme::conforming;
  problem.mesh.refine = 1;
  const Solution fine = solved(problem);
  const double energy = energy_by(*fine.summary.error_bound);
  problem.scheme = scheme;
  problem.mesh.refine = 0;
  const Solution coarse = solved(problem);
  const ErrorBound bound = *coarse.summary.error_bound;
  const double left = left_side(distance(problem, coarse, fine, 1), coarse, fine, energy);
  EXPECT_TRUE(bound.guaranteed);
  // Without a jump it is 1.8 for ν = 0 in the conforming scheme: the corners of the fixed side.
  EXPECT_LE(bound.value, (sanitized ? 2.5 : 1.7) * left);
}

INSTANTIATE_TEST_SUITE_P(Poisson, ContactEnds,
                         testing::Combine(testing::Values(Scheme::conforming, Scheme::nonconforming),
                                          testing::ValuesIn(sanitized
                                                                ? std::vector{0.3, 0.49}
                                                                : std::vector{0., 0.1, 0.3, 0.49, 0.4999})));

/// Refinement of the traces brings their digits back; the stress that follows has to keep its balance.
TEST(Equilibrium, IsKeptWhereTheLawIsExtreme) {
  Problem problem = problems::block(Scheme::conforming, Pattern::right, 1, 0.49999999);
  problem.domain = Rectangle{};
  problem.mesh = MeshRequest(Divisions{16, 16});
  problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{0.05}}, {"top", Traction{VectorField(0, -0.01)}}};
  Problem of_contrast = problem;
  of_contrast.mesh = MeshRequest(Divisions{4, 4});
  of_contrast.material = YoungPoisson{problems::formula("x < 0.5 ? 1 : 1e9"), Field(0.3), Plane::strain};
  for (const Problem& extreme : {problem, of_contrast}) {
    const Summary summary = solved(extreme).summary;
    EXPECT_LE(summary.residuals.equilibrium, 1e-10);
    EXPECT_EQ(summary.error_bound.value().unmet, std::vector<std::string>());
  }
}

/// What an open chain has for forces is rounding beside the stress.
TEST(OpenContact, IsGuaranteed) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = problems::block(scheme, Pattern::crossed, 3, 0.3);
    problem.body = VectorField(0.1, -0.3);
    problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{10.}}};
    const Solution solution = solved(problem);
    EXPECT_EQ(solution.summary.contact.length, 0);
    EXPECT_EQ(solution.summary.error_bound->unmet, std::vector<std::string>());
  }
}

/// The same body with its points numbered the other way round.
MeshData renumbered(const Mesh& mesh) {
  const int last = static_cast<int>(mesh.points.size()) - 1;
  MeshData data{{mesh.points.rbegin(), mesh.points.rend()}, {}, {}};
  for (const auto& [a, b, c] : mesh.triangles) data.triangles.push_back({last - a, last - b, last - c});
  for (const BoundaryPart& part : mesh.boundary) {
    data.boundary.emplace_back(part.name, std::vector<std::array<int, 2>>());
    for (const int edge : part.edges)
      data.boundary.back().second.push_back({last - mesh.edges[edge][0], last - mesh.edges[edge][1]});
  }
  return data;
}

/// Across a corner of the polygon u_n jumps: a clearance that did not would hold the body there, on any mesh.
TEST(ContactThatBends, IsSolvedAsWellAsContactThatDoesNot) {
  std::vector<ErrorBound> bounds;
  for (const int refine : {0, 1, 2}) {
    Problem problem = lowered_disc(Scheme::conforming);
    problem.mesh.refine = refine;
    const Solution solution = solved(problem);
    bounds.push_back(*solution.summary.error_bound);
    if (refine > 0) continue;
    // A row for either side of each corner, in the order along the part.
    Problem other = problem;
    other.domain = renumbered(*solution.mesh);
    other.mesh = {};
    for (const Solution& each : {solution, solved(other)}) {
      const auto arc = std::ranges::find(each.contact, "arc", &ContactPart::name);
      ASSERT_GE(arc->points.size(), 4u);
      for (std::size_t i = 1; i + 1 < arc->points.size(); i += 2)
        EXPECT_EQ(arc->points[i], arc->points[i + 1]);
    }
  }
  EXPECT_LE(bounds[1].value, 0.6 * bounds[0].value);
  EXPECT_LE(bounds[2].value, 0.6 * bounds[1].value);
  for (const ErrorBound& bound : bounds) {
    EXPECT_LE(bound.energy_lower, bounds[2].energy_upper);
    EXPECT_GE(bound.energy_upper, bounds[2].energy_lower);
  }
}

TEST(SmoothBody, TheBoundFallsAtTheRateOfTheScheme) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const auto& [scheme, order] : {std::pair(Scheme::conforming, 1.85), {Scheme::nonconforming, 0.95}}) {
    std::vector<double> bounds;
    for (const int n : {16, 32, 64}) bounds.push_back(Smooth(scheme, 0.4999, n).bound.value);
    EXPECT_GE(rate(bounds), order);
  }
}

using PatchCase = std::tuple<Scheme, double>;
class CertifiedPatch : public testing::TestWithParam<PatchCase> {};

TEST_P(CertifiedPatch, HasNoError) {
  const auto [scheme, poisson] = GetParam();
  for (const Problem& problem : {problems::pressed_block(scheme, Pattern::right, poisson, 2),
                                 problems::lowered_block(scheme, Pattern::crossed, poisson, 0.01, 0.03)}) {
    const ErrorBound bound = *solved(problem).summary.error_bound;
    EXPECT_TRUE(bound.guaranteed);
    // The contact term is a square, so that the bound has the root of its rounding, which grows like
    // 1 / (1 − 2 ν).
    EXPECT_LE(bound.relative, 1e-7 / std::sqrt(1 - 2 * poisson));
    EXPECT_LE(std::max(bound.parts.constitutive, bound.parts.equilibration),
              1e-8 * bound.value / bound.relative);
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, CertifiedPatch,
                         testing::Combine(testing::Values(Scheme::conforming, Scheme::nonconforming),
                                          testing::Values(0., 0.3, 0.4999)));

/// A block clamped at its top and pressed on a curved foundation, with a random load and random gap.
Problem random_punch(unsigned seed, Scheme scheme, double poisson, int n) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double middle = unit(generator), curvature = 0.2 * unit(generator),
               depth = 0.02 + 0.05 * unit(generator);
  const double shift = 0.02 * (unit(generator) - 0.5), push = 0.2 * (unit(generator) - 0.5);
  Problem problem;
  problem.mesh = {Divisions{n, n}, Pattern::right};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(poisson), Plane::strain};
  const std::string gap = std::to_string(curvature) + " * (x - " + std::to_string(middle) + ")^2";
  problem.boundary = {{"top", Fixed{VectorField(shift, -depth)}},
                      {"bottom", Contact{problems::formula(gap)}},
                      {"left", Traction{VectorField(push, 0)}}};
  return problem;
}

/// The energies of a mesh two levels finer enclose the exact one.
/// Where one node alone touches, no pressure on its two edges need have the force and the moment of σ_h.
TEST(RandomPunch, TheBoundsOfTheEnergyOfCoarseMeshesEncloseThoseOfFineOnes) {
  int not_guaranteed = 0;
  for (unsigned seed = 1; seed <= (sanitized ? 2 : 10); ++seed)
    for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
      for (const double poisson : {0.3, 0.4999}) {
        const ErrorBound coarse = *solved(random_punch(seed, scheme, poisson, 6)).summary.error_bound;
        const ErrorBound fine =
            *solved(random_punch(seed, Scheme::conforming, poisson, 24)).summary.error_bound;
        if (!coarse.guaranteed) {
          ++not_guaranteed;
          continue;
        }
        EXPECT_LE(coarse.energy_lower, fine.energy_upper);
        EXPECT_GE(coarse.energy_upper, fine.energy_lower);
        // The primal part of the left side is below the bound.
        EXPECT_LE(2 * (coarse.energy_upper - fine.energy_upper), coarse.value * coarse.value);
      }
  EXPECT_LE(not_guaranteed, 4);
}

/// Between the points where it is known a function may be anything.
TEST(Certificate, GuaranteesNothingForAGapThatIsAFunction) {
  Problem problem = problems::pressed_block(Scheme::conforming, Pattern::right, 0.3, 2);
  Contact& contact = std::get<Contact>(problem.boundary.at("bottom"));
  contact.gap = problems::formula("0.001 * x^2");
  EXPECT_TRUE(solved(problem).summary.error_bound->guaranteed);
  contact.gap = Field([](const Point& x, const Vector&) { return 0.001 * x.x() * x.x(); }, "/test");
  const ErrorBound bound = *solved(problem).summary.error_bound;
  EXPECT_FALSE(bound.guaranteed);
  ASSERT_FALSE(bound.unmet.empty());
  EXPECT_NE(bound.unmet[0].find("/test"), std::string::npos) << bound.unmet[0];
}

/// One edge touches, and has no pressure p* ≥ 0 with the moment of σ_h, though one with its force.
TEST(Certificate, CarriesALackThatIsAMoment) {
  Problem problem;
  problem.scheme = Scheme::conforming;
  problem.material = YoungPoisson{Field(1), Field(0), Plane::strain};
  problem.boundary = {{"top", Fixed{VectorField(0, -0.05)}}};
  for (const char* gap : {"0.06 * x", "0.1 * x", "0.1 * (1 - x)"}) {
    problem.boundary["bottom"] = Contact{problems::formula(gap)};
    problem.mesh = MeshRequest(Divisions{1, 1});
    const ErrorBound coarse = *solved(problem).summary.error_bound;
    problem.mesh.refine = 4;
    const ErrorBound fine = *solved(problem).summary.error_bound;
    EXPECT_TRUE(coarse.guaranteed && fine.guaranteed);
    EXPECT_LE(coarse.energy_lower, fine.energy_upper) << gap;
    EXPECT_GE(coarse.energy_upper, fine.energy_lower) << gap;
  }
}

/// A block that is pulled down at its right side and touches with its last edge: the linear pressure with the
/// force and the moment of σ_h is negative at that edge's other end. Carried to the fixed side, that moment
/// cost twenty times the rest of the bound.
TEST(Certificate, OfASingleEdgeThatTouchesIsWorthIt) {
  for (const int n : {5, 6, 7}) {
    Problem problem = problems::block(Scheme::conforming, Pattern::right, 1, 0.25);
    problem.domain = Rectangle{};
    problem.mesh = MeshRequest(Divisions{n, n});
    problem.boundary = {{"top", Fixed{}},
                        {"right", Traction{VectorField(0, -0.1)}},
                        {"bottom", Contact{0.06, Vector(0, -1)}}};
    const Solution coarse = solved(problem);
    const ErrorBound bound = *coarse.summary.error_bound;
    problem.mesh.refine = 2;
    const Solution fine = solved(problem);
    const double energy = energy_by(*fine.summary.error_bound);
    EXPECT_TRUE(bound.guaranteed);
    EXPECT_LE(bound.energy_lower, energy);
    EXPECT_GE(bound.energy_upper, energy);
    EXPECT_LE(bound.relative, 0.65) << n;
    const double left = left_side(distance(problem, coarse, fine, 2), coarse, fine, energy);
    EXPECT_GE(bound.value, left) << n;
    EXPECT_LE(bound.value, 2.6 * left) << n;
  }
}

/// p* where it is steep: not negative, with the force and the moment of p_h.
TEST(ContactPressure, IsSteepOnASingleEdgeThatTouches) {
  Problem problem = problems::block(Scheme::conforming, Pattern::right, 1, 0.25);
  problem.domain = Rectangle{};
  problem.mesh = MeshRequest(Divisions{6, 6});
  problem.boundary = {
      {"top", Fixed{}}, {"right", Traction{VectorField(0, -0.1)}}, {"bottom", Contact{0.06, Vector(0, -1)}}};
  for (const bool mirrored : {false, true}) {
    if (mirrored)
      problem.boundary = {{"top", Fixed{}},
                          {"left", Traction{VectorField(0, -0.1)}},
                          {"bottom", Contact{0.06, Vector(0, -1)}}};
    const Solution solution = solved(problem);
    double force = 0, moment = 0;
    ASSERT_FALSE(solution.admissible_pressure.empty());
    for (const EdgePressure& own : solution.admissible_pressure) {
      EXPECT_GE(std::min(own.at_ends[0], own.at_ends[1]), 0);
      const auto& [a, b] = solution.mesh->edges[own.edge];
      constexpr int parts = 100'000;
      for (int i = 0; i < parts; ++i) {
        const double s = (i + 0.5) / parts, share = own(s) * solution.mesh->length(own.edge) / parts;
        force += share;
        moment += share * ((1 - s) * solution.mesh->points[a].x() + s * solution.mesh->points[b].x());
      }
    }
    const Reaction& reaction = solution.summary.parts.front().part == "bottom"
                                   ? solution.summary.parts.front()
                                   : *std::ranges::find(solution.summary.parts, "bottom", &Reaction::part);
    EXPECT_NEAR(force, reaction.force[1], 1e-8 * force);
    EXPECT_NEAR(moment, reaction.moment, 1e-8 * force);
    EXPECT_TRUE(std::ranges::any_of(solution.admissible_pressure,
                                    [](const EdgePressure& own) { return own.end - own.begin < 0.99; }));
  }
}

/// A block on a chain of twenty edges that bend by so little from one to the next that they touch nearly
/// along one direction, and its mirror image, which has the same energy.
TEST(Certificate, OfBendsBetweenShortEdgesHoldsInTheMirror) {
  const auto bent = [](Scheme scheme, double bend, double shift) {
    Polygon block;
    Point x(-1, 0);
    for (int i = 0; i < 20; ++i) {
      block.vertices.push_back(x);
      block.sides.push_back("bottom");
      x += Vector(0.1, 0.1 * (i - 9.5) * bend);
    }
    block.vertices.insert(block.vertices.end(), {x, {1, 1}, {-1, 1}});
    block.sides.insert(block.sides.end(), {"right", "top", "left"});
    Problem problem;
    problem.domain = block;
    problem.mesh = MeshRequest(LargestEdge{0.2});
    problem.mesh.refine = sanitized ? 0 : 2;
    problem.scheme = scheme;
    problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
    problem.boundary = {{"top", Fixed{VectorField(shift, -1e-3)}}, {"bottom", Contact{}}};
    return *solved(problem).summary.error_bound;
  };
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double bend : {1e-7, 4e-5}) {
      const ErrorBound one = bent(scheme, bend, 1), other = bent(scheme, bend, -1);
      EXPECT_TRUE(one.guaranteed && other.guaranteed) << bend;
      EXPECT_LE(one.energy_lower, other.energy_upper) << bend;
      EXPECT_GE(one.energy_upper, other.energy_lower) << bend;
    }
}

TEST(Certificate, OfAStiffPartBesideASoftOneIsAsGoodAsOfOnePart) {
  const auto relative = [](Scheme scheme, const std::string& young) {
    Problem problem = problems::block(scheme, Pattern::right, 1, 0.3);
    problem.domain = Rectangle{};
    problem.mesh.fineness = Divisions{8, 8};
    problem.material = YoungPoisson{problems::formula(young), 0.3, Plane::strain};
    problem.boundary = {
        {"left", Fixed{VectorField(0, 0)}}, {"bottom", Contact{0.05}}, {"top", Pressure{0.01}}};
    return solve(problem, {ActiveSet{}, {}}).summary.error_bound.value().relative;
  };
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const double one = relative(scheme, "1 + 0*x");
    for (const char* contrast : {"1e3", "1e5", "1e7"})
      EXPECT_LE(relative(scheme, std::string("x < 0.5 ? 1 : ") + contrast), 1.5 * one) << contrast;
  }
}

TEST(Certificate, OfAnElasticBodyDoesNotDependOnUnits) {
  const ErrorBound plain = *solved(random_punch(3, Scheme::conforming, 0.3, 8)).summary.error_bound;
  Problem problem = random_punch(3, Scheme::conforming, 0.3, 8);
  problem.material = YoungPoisson{Field(1e9), Field(0.3), Plane::strain};
  problem.boundary["left"] = Traction{};
  Problem stiff = problem;
  stiff.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  EXPECT_NEAR(solved(problem).summary.error_bound->relative, solved(stiff).summary.error_bound->relative,
              1e-9 * plain.relative);
}

}  // namespace
}  // namespace signorini::elastic_certificate_test
