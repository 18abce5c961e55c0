// Hertz's contact through the API: the half-disc of api/examples/hertz-half-disc.json, against values of an
// independent program.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "api/examples.hpp"
#include "api/problem_json.hpp"
#include "solve.hpp"

namespace signorini::api {
namespace {

Request half_disc() {
  for (const Example& example : examples())
    if (example.name == "hertz-half-disc") {
      Request request = parse_request(example.json);
      request.problem.scheme = Scheme::conforming;
      return request;
    }
  ADD_FAILURE() << "the example is missing";
  return {};
}

/// The longest edge where the body touches.
constexpr double kEdge = 0.005;

TEST(Hertz, HalfDiscAgainstIndependentValues) {
  const Request request = half_disc();
  const Summary summary = solve(request.problem, request.settings).summary;
  ASSERT_EQ(summary.outcome, Outcome::converged);
  EXPECT_LE(summary.triangles, 60000);
  EXPECT_NEAR(summary.contact.force / 1.056127, 1, 0.005);
  EXPECT_NEAR(summary.contact.max_pressure / 8.6125, 1, 0.015);
  EXPECT_NEAR(summary.contact.length / 2, 0.078008, 0.01 * 0.078008 + kEdge);
}

/// Hertz's pressure (2 F / π a) √(1 − (x/a)²) has a² = 4 ∫ p x² / F, and a² = 4 F R (1 − ν²) / (π E). He takes
/// the body for a half-plane, which leaves out terms of the order (a/R)²; R is 1 here. The mesh is generated
/// and may differ from machine to machine, so the tolerances scale with the edges, too.
TEST(Hertz, ThePressureTendsToHertzAsTheOverlapFalls) {
  constexpr double edge = kEdge / 2;
  Request request = half_disc();
  request.problem.mesh.sizes[0].size = edge;
  for (const double delta : {0.02, 0.01, 0.005}) {
    std::get<Contact>(request.problem.boundary.at("contact")).gap =
        Field([=](const Point& x, const Vector&) { return x.y() - delta; }, "/test");
    const Solution solution = solve(request.problem, request.settings);
    const double force = solution.summary.contact.force;
    const double half_width = std::sqrt(4 * force * (1 - 0.09) / (std::numbers::pi * 200));
    const double peak = 2 * force / (std::numbers::pi * half_width);
    EXPECT_NEAR(solution.summary.contact.max_pressure / peak, 1, 0.02 + edge / half_width);
    EXPECT_NEAR(solution.summary.contact.length / 2, half_width, 2 * edge);
    const ContactPart& part = solution.contact[0];
    double moment = 0;
    for (std::size_t i = 0; i < part.points.size(); ++i)
      moment += part.weight[i] * part.pressure[i] * std::pow(part.points[i].x(), 2);
    EXPECT_NEAR(2 * std::sqrt(moment / force) / half_width, 1, 0.75 * half_width * half_width) << delta;
  }
}

}  // namespace
}  // namespace signorini::api
