// Every example of api/examples, solved as it stands, against values from elsewhere.
#include <gtest/gtest.h>

#include <cmath>

#include "api/examples.hpp"
#include "api/problem/problem_json.hpp"
#include "solve.hpp"

namespace signorini::api::example_values_test {
namespace {

/// A value from elsewhere, and how far the example's own mesh may be from it, relative.
struct Value {
  double value, tolerance;
};

struct Expected {
  std::string_view name;
  Value energy, force;
};

/// Unless a comment says otherwise, the values are those of quadratic displacements, as
/// tests/campaign/energy.py computes them, on meshes so fine that their own error is far below the tolerance.
const std::vector<Expected> all_expected{
    // The energy lies between the guaranteed bounds −0.42375662 and −0.42375654 of a solve to 0.1 %.
    {"adaptive-mesh", {-0.4237566, 3e-5}, {1.56482, 1e-4}},
    // The solution is that of signorini-edge below, on a coarser mesh.
    {"convergence-study", {1.7216903620444786, 1e-5}, {1, 5e-3}},
    {"elastic-block", {-0.0266777003, 2e-5}, {2, 1e-11}},  // force: the pressure 1 on the length 2
    {"gap-sweep", {-0.00395407822, 0.015}, {1.63663481, 0.01}},
    // Force: the traction 0.1 on the roof, 2 hypot(1, 0.2).
    {"given-mesh", {-0.00464453704, 5e-3}, {0.2 * std::hypot(1, 0.2), 1e-11}},
    {"gmsh-block", {-0.00168815688, 2e-3}, {0.749933685, 1e-3}},
    // The supports' reactions at the corners count in the force, but not in that of energy.py.
    {"graded-stiffness", {-0.435825844, 1e-3}, {0.292836384, 0.08}},
    {"held-by-contact", {-0.0804106306, 1e-3}, {1, 1e-11}},  // force: the load
    // The force to six digits by an independent program on finer meshes.
    {"hertz-half-disc", {0.00487638, 5e-3}, {1.056127, 5e-3}},
    {"orthotropic-cantilever", {-0.0060599215, 6e-3}, {0.0498736527, 1e-2}},
    // The energies of an independent mixed saddle-point program on the same spaces, the exact force of
    // problems/membrane.hpp; the iteration stops at 1e-5.
    {"paper-conforming", {-0.914872894016581, 1e-4}, {2 * 0.493948767, 0.012}},
    {"paper-nonconforming", {-0.9401673749751565, 1e-4}, {2 * 0.493948767, 0.012}},
    {"plate-with-hole", {-0.0132610149, 1e-4}, {2.48496902, 1e-4}},
    // u = Re z^(3/2): the force is ∫ 3/2 √−x over (−1, 0), the energy ½ ∫ u ∂u/∂n over the boundary.
    {"signorini-edge", {1.72169054, 1e-5}, {1, 1e-3}},
    {"traction-crossed", {-0.00629061455, 2e-5}, {0.0762928522, 1e-3}},
    {"varying-gap", {-0.916763962, 3e-3}, {1.29746812, 2e-3}},
};

void expect_near(double found, const Value& expected) {
  EXPECT_NEAR(found / expected.value, 1, expected.tolerance);
}

TEST(ExampleValues, AreThoseOfIndependentPrograms) {
  ASSERT_EQ(all_expected.size(), examples().size());
  for (std::size_t i = 0; i < examples().size(); ++i) {
    SCOPED_TRACE(examples()[i].name);
    ASSERT_EQ(all_expected[i].name, examples()[i].name);
    const Request request = parse_request(examples()[i].json);
    const Summary summary = solve(request.problem, request.settings).summary;
    EXPECT_EQ(summary.outcome, Outcome::converged);
    expect_near(summary.energy, all_expected[i].energy);
    expect_near(summary.contact.force, all_expected[i].force);
  }
}

}  // namespace
}  // namespace signorini::api::example_values_test
