// Problem documents of elastic bodies and of every kind of domain, read into the solver's types.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "api/problem/problem_json.hpp"
#include "solve.hpp"

namespace signorini::api::elasticity_json_test {
namespace {

using nlohmann::json;

json block() {
  return json::parse(R"({
    "model": "elasticity", "domain": {"type": "rectangle"}, "mesh": {"divisions": [4, 4]},
    "material": {"young": 200, "poisson": 0.3, "plane": "stress"}, "load": {"body": [0, "-x"]},
    "boundary": {"left": {"type": "roller"}, "right": {"type": "fixed", "value": ["y", 1]},
                 "top": {"type": "traction", "pressure": "2 * x"}, "bottom": {"type": "contact", "gap": "x * ny"}},
    "scheme": "conforming"})");
}

TEST(Elasticity, IsReadMemberByMember) {
  const Problem problem = parse_request(block().dump()).problem;
  const auto& material = std::get<YoungPoisson>(problem.material);
  EXPECT_EQ(material.young(Point(0, 0)), 200);
  EXPECT_EQ(material.poisson(Point(0, 0)), 0.3);
  EXPECT_EQ(material.plane, Plane::stress);
  EXPECT_EQ(problem.body(1, Point(0.25, 0)), -0.25);
  EXPECT_TRUE(condition_on<Roller>(problem, "left"));
  EXPECT_EQ(condition_on<Fixed>(problem, "right")->value(0, Point(1, 0.5)), 0.5);
  EXPECT_EQ(condition_on<Fixed>(problem, "right")->value(1, Point(1, 0.5)), 1);
  EXPECT_EQ(condition_on<Pressure>(problem, "top")->value(Point(0.5, 1)), 1);
  EXPECT_EQ(condition_on<Contact>(problem, "bottom")->gap(Point(0.5, 0), Vector(0, -1)), -0.5);
}

TEST(Elasticity, ATensorIsItsUpperTriangle) {
  json document = block();
  document["material"] = json::parse(R"({"tensor": [[10, 1, 0.5], [1, 4, "0.1 * x"], [0.5, "0.1 * x", 2]]})");
  const Problem problem = parse_request(document.dump()).problem;
  const auto& entries = std::get<HookeTensor>(problem.material).entries;
  const std::array expected{10., 1., 0.5, 4., 0.2, 2.};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(entries[i](Point(2, 0)), expected[i]);
}

TEST(Domains, APolygonHasItsSidesAndSizes) {
  json document = block();
  document["domain"] = json::parse(R"({"type": "polygon", "vertices": [[0, 0], [1, 0], [1, 1], [0, 1]],
                                       "sides": ["bottom", "right", "top", "left"]})");
  document["mesh"] =
      json::parse(R"({"size": 0.5, "sizes": [{"at": [1, 1], "radius": 0.1, "size": 0.05}], "refine": 1})");
  const Problem problem = parse_request(document.dump()).problem;
  EXPECT_EQ(std::get<Polygon>(problem.domain).vertices[2], Point(1, 1));
  EXPECT_EQ(problem.mesh.sizes.at(0).size, 0.05);
  EXPECT_EQ(problem.mesh.refine, 1);
  const Solution solution = solve(problem, {ActiveSet{}, {}});
  EXPECT_EQ(estimate(problem).triangles, solution.summary.triangles);
  EXPECT_EQ(estimate(problem).unknowns.stress, solution.summary.unknowns.stress);
  EXPECT_EQ(estimate(problem).unknowns.contact, solution.summary.unknowns.contact);
}

/// The block in a turned frame, by a mesh of triangles of its own: the answer turns with it.
TEST(Domains, ATurnedMeshTurnsTheAnswer) {
  json document = json::parse(R"({
    "model": "elasticity",
    "domain": {"type": "mesh", "points": [[0, 0], [2, 0], [2, 1], [0, 1], [0.9, 0.4]],
               "triangles": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
               "boundary": {"bottom": [[0, 1]], "right": [[1, 2]], "top": [[2, 3]], "left": [[3, 0]]}},
    "mesh": {"refine": 2}, "material": {"young": 3, "poisson": 0.3},
    "boundary": {"left": {"type": "roller"}, "bottom": {"type": "contact"}, "top": {"type": "traction", "pressure": 0.7}},
    "scheme": "conforming", "solver": {"method": "active_set"}})");
  for (const char* scheme : {"conforming", "nonconforming"}) {
    document["scheme"] = scheme;
    const double c = std::cos(std::acos(-1.) / 6), s = std::sin(std::acos(-1.) / 6);
    json turned = document;
    for (json& point : turned["domain"]["points"])
      point = {c * point[0].get<double>() - s * point[1].get<double>(),
               s * point[0].get<double>() + c * point[1].get<double>()};
    const Request request = parse_request(turned.dump());
    const Solution solution = solve(request.problem, request.settings);
    // σ = −p e eᵀ for e = (−sin, cos), the turned y axis.
    const Eigen::Vector3d stress(-0.7 * s * s, -0.7 * c * c, 0.7 * s * c);
    for (Eigen::Index t = 0; t < solution.stress_at_centroids.cols(); ++t)
      ASSERT_LT((solution.stress_at_centroids.col(t) - stress).norm(), 1e-11);
    EXPECT_NEAR(solution.summary.contact.force, 1.4, 1e-11);
  }
}

/// A mesh of two triangles has no place for PEERS to be stable on: its corners are split.
TEST(Domains, CornersAreSplitWhereThePairNeedsIt) {
  json document = block();
  document["mesh"] = {{"divisions", {1, 1}}};
  document["scheme"] = "nonconforming";
  document["boundary"] = json::parse(R"({"left": {"type": "fixed"}})");
  const Request request = parse_request(document.dump());
  const Solution solution = solve(request.problem, {ActiveSet{}, {}});
  EXPECT_GT(solution.summary.triangles, 2);
  EXPECT_LT(solution.summary.residuals.equilibrium, 1e-11);
}

}  // namespace
}  // namespace signorini::api::elasticity_json_test
