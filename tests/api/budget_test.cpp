// What is done with a problem before it is taken in costs little, whatever the problem asks for.

#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "../problems/json_problems.hpp"
#include "../problems/sanitized.hpp"
#include "../problems/seconds_at_work.hpp"
#include "api/document/json_document.hpp"
#include "api/problem/problem_json.hpp"
#include "faults_of.hpp"
#include "solve.hpp"

namespace signorini::api::budget_test {
namespace {

using nlohmann::json;
using problems::membrane_on;
using problems::ring;

/// All that a thread of the service does with a body.
void look_at(const std::string& body) {
  const Request request = parse_request(body);
  estimate(request.problem, request.sweep, request.study, request.settings);
  look_ahead(request.problem, request.sweep);
}

/// How much longer than a hundredth of a second this thread takes now for what took so long where the bound
/// was set, a document read and numbers sorted; 1 if it takes no longer. Machines that share their cores with
/// others are at times half as fast.
double slowness() {
  constexpr double seconds = 0.01;
  static const std::string text = json(ring(5000)).dump();
  const double begin = seconds_at_work();
  const json points = json::parse(text);
  std::vector<double> numbers;
  for (const json& point : points)
    for (double x : point.get<std::vector<double>>())
      for (int i = 0; i < 5; ++i) numbers.push_back(x = std::fmod(7 * x + 3, 1));
  std::ranges::sort(numbers);
  return std::max(1., (seconds_at_work() - begin) / seconds);
}

/// The pointer of the first fault; `malformed` if the body is no document, empty if the problem may be taken
/// in.
std::string found_soon(const json& problem) {
  const std::string body = problem.dump();
  std::string found;
  double least = 1e9;
  for (int attempt = 0; attempt < 3 && least > 0.1; ++attempt) {
    const double begin = seconds_at_work();
    try {
      const auto pointers = pointers_of(faults_of([&] { look_at(body); }));
      found = pointers.empty() ? "" : pointers.front().empty() ? "the whole" : pointers.front();
    } catch (const MalformedJson&) {
      found = "malformed";
    }
    const double taken = seconds_at_work() - begin;
    least = std::min(least, taken / slowness());
  }
  if (!sanitized) {
    EXPECT_LT(least, 0.15) << body.substr(0, 200);
  }
  return found;
}

json polygon(const json& vertices, const json& mesh) {
  return membrane_on({{"type", "polygon"}, {"vertices", vertices}}, mesh);
}

json square() {
  return membrane_on({{"type", "rectangle"}}, {{"divisions", {8, 8}}});
}

json with_holes(int holes) {
  const int row = static_cast<int>(std::ceil(std::sqrt(holes)));
  json problem = polygon({{-1, -1}, {row, -1}, {row, row}, {-1, row}}, {{"size", row / 4.}});
  for (int i = 0; i < holes; ++i)
    problem["domain"]["holes"].push_back(ring(4, 0.2, i % row, std::floor(i / row)));
  return problem;
}

json zigzag(int vertices, double turn) {
  json points = json::array();
  const auto add = [&](double x, double y) {
    points.push_back({std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y});
  };
  for (int i = 0; i < vertices - 2; ++i) add(i * 1e-3, i % 2);
  add((vertices - 3) * 1e-3, -1);
  add(0, -1);
  return polygon(points, {{"size", 1}});
}

/// A strip wound up, whose windings lie closer to each other than their edges are long.
json spiral(int vertices, double turn, double rise, double width) {
  json points = json::array();
  const auto add = [&](int i, double radius) {
    const double angle = turn * i;
    points.push_back({(radius + rise * i) * std::cos(angle), (radius + rise * i) * std::sin(angle)});
  };
  for (int i = 0; i < vertices / 2; ++i) add(i, 1);
  for (int i = vertices / 2 - 1; i >= 0; --i) add(i, 1 + width);
  return polygon(points, {{"size", 5}});
}

/// Narrow teeth on a back.
json comb(int teeth, double depth, double width) {
  json points = json::array();
  for (int i = 0; i < teeth; ++i) {
    points.push_back({i, depth});
    points.push_back({i + width, depth});
    if (i == teeth - 1) break;
    points.push_back({i + width, 1});
    points.push_back({i + 1, 1});
  }
  points.push_back({teeth - 1 + width, 0});
  points.push_back({0, 0});
  return polygon(points, {{"size", depth}});
}

json swept(json problem, std::size_t entries, const json& entry) {
  problem["sweep"] = json(entries, entry);
  return problem;
}

std::string long_formula(std::size_t characters) {
  std::string formula = "1";
  while (formula.size() + 9 <= characters) formula += "+sin(7*x)";
  return formula;
}

TEST(Budget, APolygonIsMeasuredAndNotMeshed) {
  EXPECT_EQ(found_soon(polygon(ring(100), {{"size", 2e-3}})), "");
  EXPECT_EQ(found_soon(polygon(ring(9990), {{"size", 0.1}})), "");
  json local = polygon(ring(1000), {{"size", 1}});
  for (int i = 0; i < 500; ++i)
    local["mesh"]["sizes"].push_back({{"at", {1e-3 * i, 0}}, {"radius", 0.01}, {"size", 1e-3}});
  EXPECT_EQ(found_soon(local), "");
}

/// Pairs of edges that lie closer to each other than they are long are many.
/// Every tooth is near to all others, and a study looks at all of them for each of its meshes.
TEST(Budget, CombsOfDeepTeethAreMeasuredToo) {
  const auto deep = [](int teeth) {
    json points{{0, 0}, {1, 0}};
    for (int i = 2 * teeth; i >= 0; --i) points.push_back({i / (2. * teeth), 1 + i % 2});
    return polygon(points, {{"size", 1}});
  };
  EXPECT_EQ(found_soon(deep(220)), "");
  EXPECT_THAT(found_soon(deep(298)), testing::StartsWith("/domain/vertices"));
  json study = deep(220);
  study["study"] = {{"schemes", {"conforming", "nonconforming"}}, {"check", {"inf_sup"}}};
  for (int i = 0; i < 64; ++i) study["study"]["sizes"].push_back(1 - 0.01 * i);
  EXPECT_NE(found_soon(study), "malformed");
  for (int i = 0; i < 500; ++i)
    study["mesh"]["sizes"].push_back({{"at", {0.5, 1.5}}, {"radius", 5}, {"size", 0.5}});
  EXPECT_EQ(found_soon(study), "/study/sizes");
}

/// Points that lie in two long rows, or on two circles close to each other.
TEST(Budget, ThinStripsAreMeasuredToo) {
  json strip = json::array();
  for (int i = 0; i < 5000; ++i) strip.push_back({i * 2e-4, 0});
  for (int i = 4999; i >= 0; --i) strip.push_back({i * 2e-4, 0.01});
  EXPECT_EQ(found_soon(polygon(strip, {{"size", 1}})), "");
  json rings = polygon(ring(4990), {{"size", 1}});
  rings["domain"]["holes"] = json::array({ring(4990, 0.998)});  // braces alone are a copy to Clang
  EXPECT_EQ(found_soon(rings), "");
}

TEST(Budget, AnIntricatePolygonIsMeasuredTooOrRefused) {
  for (const int vertices : {3998, 9998})
    for (const double width : {0.1, 0.3})
      EXPECT_THAT(found_soon(spiral(vertices, 0.1, 0.01, width)), testing::Not("malformed"));
  EXPECT_THAT(found_soon(spiral(9998, 0.07, 0.01, 0.4)), testing::Not("malformed"));
  for (const double depth : {8., 20., 50.}) {
    json problem = comb(2499, depth, 0.5);
    EXPECT_THAT(found_soon(problem), testing::Not("malformed"));
    for (int i = 0; i < 500; ++i)
      problem["mesh"]["sizes"].push_back({{"at", {5 * i, depth / 2}}, {"radius", 50}, {"size", 0.4}});
    EXPECT_THAT(found_soon(problem), testing::Not("malformed"));
  }
}

TEST(Budget, APolygonHasLimits) {
  EXPECT_EQ(found_soon(with_holes(1900)), "");
  EXPECT_EQ(found_soon(with_holes(16'000)), "/domain/holes");
  EXPECT_EQ(found_soon(zigzag(24'000, 0)), "/domain/vertices");
  for (const double turn : {0., std::numbers::pi / 4, std::numbers::pi / 2})
    EXPECT_NE(found_soon(zigzag(9'990, turn)), "");
}

TEST(Budget, RefinementsAreCountedAndNotMade) {
  const json two{{"type", "mesh"},
                 {"points", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}},
                 {"triangles", {{0, 1, 2}, {0, 2, 3}}},
                 {"boundary", {{"rim", {{0, 1}, {1, 2}, {2, 3}, {3, 0}}}}}};
  EXPECT_EQ(found_soon(membrane_on(two, {{"refine", 11}})), "");
}

TEST(Budget, OnlyAMeshHasMillionsOfValues) {
  json entries = square();
  entries["sweep"] = json(350'000, json::object());
  EXPECT_EQ(found_soon(entries), "malformed");
}

/// Of no other is the end looked for. Blanks between values are no text.
TEST(Budget, OnlyADomainHasLongTexts) {
  json titled = square();
  titled["title"] = std::string(15'000'000, 't');
  EXPECT_EQ(found_soon(titled), "malformed");
  json named = square();
  named[std::string(15'000'000, 'n')] = 1;
  EXPECT_EQ(found_soon(named), "malformed");
  EXPECT_EQ(parse_json("{" + std::string(15'000'000, ' ') + "}"), json::object());
  EXPECT_EQ(found_soon({{"domain", {{"type", "gmsh"}, {"msh", std::string(2'000'000, 'm')}}}}), "/model");
}

/// A worker reads megabytes, and hears that it is to stop meanwhile.
TEST(Budget, ReadingALongTextMayBeEnded) {
  class Ends : public Observer {
   public:
    bool keep_going() override { return ++asked_ < 10; }
    int asked() const { return asked_; }

   private:
    int asked_ = 0;
  } ends;
  json long_mesh = square();
  long_mesh["domain"] = {{"type", "mesh"}, {"points", json(50'000, json{0, 0})}};
  EXPECT_THROW(parse_request(long_mesh.dump(), &ends), Cancelled);
  EXPECT_EQ(ends.asked(), 10);
}

TEST(Budget, ASweepIsReadOnce) {
  json contact = square();
  contact["boundary"]["bottom"] = {{"type", "contact"}};
  const auto gap = [](const json& value) { return json{{"boundary", {{"bottom", {{"gap", value}}}}}}; };
  EXPECT_EQ(found_soon(swept(contact, 10'000, gap(long_formula(1000)))), "malformed");
  EXPECT_EQ(found_soon(swept(contact, 1000, gap(long_formula(980)))), "");
  EXPECT_EQ(found_soon(swept(contact, 10'000, gap("0.1 * x"))), "");
  EXPECT_EQ(found_soon(swept(polygon(ring(2000), {{"size", 1}}), 10'000, json::object())), "/sweep");
}

TEST(Budget, FaultsAreNotCollectedForEver) {
  json unknown = square();
  for (int i = 0; i < 90'000; ++i) unknown["u" + std::to_string(i)] = 1;
  EXPECT_EQ(found_soon(unknown), "/u0");
  for (int i = 0; i < 120'000; ++i) unknown["v" + std::to_string(i)] = 1;
  EXPECT_EQ(found_soon(unknown), "malformed");
  json parts = polygon(ring(2000), {{"size", 1}});
  for (int i = 0; i < 2000; ++i) parts["boundary"]["sidf" + std::to_string(i)] = {{"type", "fixed"}};
  EXPECT_EQ(found_soon(parts), "/boundary/sidf0");
}

TEST(Budget, LongFormulasAreTriedInFewPlaces) {
  json problem = polygon(ring(1000), {{"size", 0.05}});
  problem["material"]["stiffness"] = "1 + x^2 + 0 * (" + long_formula(900) + ")";
  problem["load"]["body"] = long_formula(990);
  EXPECT_EQ(found_soon(problem), "");
}

/// Of slow operations, on all edges of a strip.
TEST(Budget, LongDataAreTriedOnFewEdges) {
  std::string slow = "x^2.5^y^x";
  while (slow.size() < 980) slow += "+x^2.5^y^x";
  for (const json& condition :
       {json{{"type", "contact"}, {"gap", slow}}, json{{"type", "fixed"}, {"value", slow}},
        json{{"type", "traction"}, {"value", slow}}}) {
    json strip = membrane_on({{"type", "rectangle"}, {"size", {2, 1}}}, {{"divisions", {2000, 1}}});
    strip["boundary"] = {
        {"bottom", condition}, {"left", condition}, {"right", condition}, {"top", {{"type", "fixed"}}}};
    EXPECT_EQ(found_soon(strip), "");
  }
}

/// All of them cross, however many chords they have.
TEST(Budget, CirclesThatCrossAreNotResolvedForEver) {
  json problem = polygon({{-40, -40}, {40, -40}, {40, 40}, {-40, 40}}, {{"size", 10}});
  for (int i = 0; i < 490; ++i)
    problem["domain"]["holes"].push_back(
        {{"circle", {{"centre", {std::cos(i), std::sin(2 * i)}}, {"radius", 10 + 0.001 * i}}}});
  EXPECT_NE(found_soon(problem), "malformed");
  json star = json::array();
  for (int i = 0; i < 9000; ++i)
    star.push_back({(i % 2 + 1) * std::cos(std::numbers::pi * i / 4500),
                    (i % 2 + 1) * std::sin(std::numbers::pi * i / 4500)});
  problem["domain"]["vertices"] = star;
  for (json& hole : problem["domain"]["holes"]) hole["circle"]["radius"] = 1.5;
  EXPECT_NE(found_soon(problem), "malformed");
}

/// Chords that follow them are needed to know how narrow the domain is between arcs; a study knows it once.
TEST(Budget, ArcsThatNearlyTouchAreMeasuredOnce) {
  const auto circle = [](double x, double radius) {
    return json{{"circle", {{"centre", {x, 0.02}}, {"radius", radius}}}};
  };
  json plate = polygon({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, {{"size", 5}});
  plate["domain"]["holes"] = {circle(0.01, 0.3), circle(0.610000003, 0.3)};
  plate["study"] = {{"schemes", {"conforming", "nonconforming"}}};
  for (int i = 0; i < 64; ++i) plate["study"]["sizes"].push_back(5 - 0.01 * i);
  EXPECT_EQ(found_soon(plate), "");
  json disc = polygon(ring(1000), {{"size", 5}});
  disc["domain"]["holes"].push_back(
      {{"circle", {{"centre", {0, 0}}, {"radius", std::cos(std::numbers::pi / 1000) - 1e-6}}}});
  EXPECT_NE(found_soon(disc), "malformed");
  json grid = polygon({{0, 0}, {10, 0}, {10, 10}, {0, 10}}, {{"size", 1}});
  for (int i = 0; i < 100; ++i)
    grid["domain"]["holes"].push_back(
        {{"circle", {{"centre", {0.5 + i % 10, 0.5 + std::floor(i / 10)}}, {"radius", 0.5 - 5e-8}}}});
  EXPECT_EQ(found_soon(grid), "");
}

/// Of a local size all of the sides are asked how much of them it reaches.
TEST(Budget, AMeshWithLocalSizesIsCountedOrRefused) {
  json problem = polygon(ring(9990), {{"size", 1}});
  for (int i = 0; i < 100; ++i)
    problem["mesh"]["sizes"].push_back({{"at", {std::cos(i), std::sin(i)}}, {"radius", 10}, {"size", 1e-3}});
  EXPECT_NE(found_soon(problem), "malformed");
  problem["mesh"]["sizes"].push_back({{"at", {0, 0}}, {"radius", 10}, {"size", 1e-3}});
  EXPECT_EQ(found_soon(problem), "/mesh/sizes");
}

TEST(Budget, AStudyWithLocalSizesIsCountedOrRefused) {
  json problem = polygon(ring(100), {{"size", 0.2}});
  problem["study"] = {{"schemes", {"conforming", "nonconforming"}}, {"check", {"inf_sup"}}};
  for (int i = 0; i < 64; ++i) problem["study"]["sizes"].push_back(0.2 + 0.001 * i);
  for (int i = 0; i < 31; ++i)
    problem["mesh"]["sizes"].push_back({{"at", {0, 0.01 * i}}, {"radius", 5}, {"size", 0.1}});
  EXPECT_NE(found_soon(problem), "malformed");
  problem["mesh"]["sizes"].push_back({{"at", {0, 0}}, {"radius", 5}, {"size", 0.1}});
  EXPECT_EQ(found_soon(problem), "/study/sizes");
}

/// Both long sides bend by a millionth at each vertex: triangles of each side's row are changed by the next.
TEST(Budget, ManyVerticesInRowsAreMeshedInAnOrderOfTheirOwn) {
  const int half = 2000;
  json vertices;
  for (int i = 0; i < half; ++i) vertices.push_back({i, 1 + 1e-6 * (i % 2)});
  for (int i = half - 1; i >= 0; --i) vertices.push_back({i, 1e-6 * (i % 2)});
  EXPECT_EQ(found_soon(polygon(vertices, {{"size", 1e5}})), "");
}

/// Triangles that touch no other, in a row or one above the other.
json islands(int count, bool stacked, bool one_part) {
  json mesh{{"type", "mesh"}, {"points", json::array()}, {"triangles", json::array()}};
  for (int i = 0; i < count; ++i) {
    const double x = stacked ? 0 : 2. * i, y = stacked ? 0.001 * i : 0, height = stacked ? 0.0004 : 1;
    for (const auto& [dx, dy] : {std::pair(0., 0.), std::pair(1., height / 2), std::pair(0., height)})
      mesh["points"].push_back({x + dx, y + dy});
    mesh["triangles"].push_back({3 * i, 3 * i + 1, 3 * i + 2});
    for (int e = 0; e < 3; ++e)
      mesh["boundary"][one_part ? "all of it" : "p" + std::to_string(3 * i + e)].push_back(
          {3 * i + e, 3 * i + (e + 1) % 3});
  }
  return mesh;
}

TEST(Budget, ManyBodiesAreTriedInOnePass) {
  for (const bool stacked : {false, true})
    for (const bool one_part : {false, true})
      for (const char* type : {"fixed", "contact"}) {
        json problem = membrane_on(islands(990, stacked, one_part), json::object());
        problem["boundary"] = {{"all", {{"type", type}}}};
        problem["load"] = {{"body", -1}};
        EXPECT_NE(found_soon(problem), "malformed") << stacked << one_part << type;
      }
}

/// As many as a mesh of few triangles may have, each with a condition of its own.
TEST(Budget, ManyBodiesWithPartsOfTheirOwnAreLeftToTheSolve) {
  for (const char* scheme : {"conforming", "nonconforming"})
    for (const bool on_contact : {false, true}) {
      json problem = membrane_on(islands(3990, false, false), json::object());
      problem["model"] = "elasticity";
      problem["material"] = {{"young", 1}, {"poisson", 0.3}};
      problem["load"] = {{"body", {0, -1}}};
      problem["scheme"] = scheme;
      problem["boundary"] = json::object();
      for (const auto& [part, edges] : problem["domain"]["boundary"].items())
        problem["boundary"][part] =
            on_contact ? json{{"type", "contact"}} : json{{"type", "traction"}, {"value", {"nx", 0}}};
      problem["boundary"].front() = {{"type", "fixed"}};
      EXPECT_EQ(found_soon(problem), "") << scheme << on_contact;
    }
}

/// No mesh, but it takes a solve to see that.
TEST(Budget, ManyTrianglesOnOneEdgeAreLeftToTheSolve) {
  json mesh{{"type", "mesh"}, {"points", {{0, 0}, {1, 0}}}, {"boundary", {{"rim", json::array()}}}};
  for (int i = 0; i < 12'000; ++i) {
    mesh["points"].push_back({0.5, 1 + i});
    mesh["triangles"].push_back({0, 1, 2 + i});
    mesh["boundary"]["rim"].push_back({0, 2 + i});
  }
  json problem = membrane_on(mesh, json::object());
  problem["model"] = "elasticity";
  problem["material"] = {{"young", 1}, {"poisson", 0.3}};
  problem["load"] = {{"body", {0, -1}}};
  problem["boundary"] = {{"rim", {{"type", "fixed"}}}};
  EXPECT_EQ(found_soon(problem), "");
}

/// A few kilobytes that would be gigabytes, were each line in each of the groups.
TEST(Budget, ACurveIsInOneGroup) {
  for (const bool same : {false, true}) {
    std::string groups = "5000", lines = "1 1 1 20000";
    for (int i = 0; i < 5000; ++i) groups += same ? " 1" : ' ' + std::to_string(1 + i);
    for (int i = 0; i < 20'000; ++i) lines += "\n1 1 2";
    const std::string file =
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 1 0 0\n1 0 0 0 1 1 0 " + groups +
        " 0\n$EndEntities\n$Nodes\n1 3 1 3\n2 1 0 3\n1\n2\n3\n0 0 0\n1 0 0\n0 1 0\n" +
        "$EndNodes\n$Elements\n2 20001 1 20001\n" + lines + "\n2 1 2 1\n1 1 2 3\n$EndElements\n";
    json problem = membrane_on({{"type", "gmsh"}, {"msh", file}}, json::object());
    problem["boundary"] = {{"1", {{"type", "fixed"}}}};
    EXPECT_EQ(found_soon(problem), "/domain/msh");
  }
}

/// Or more edges than its triangles have sides.
TEST(Budget, AMeshOfManyPartsAndFewTrianglesIsNone) {
  json mesh{{"type", "mesh"},
            {"points", {{0, 0}, {1, 0}, {1, 1}, {0, 1}}},
            {"triangles", {{0, 1, 2}, {0, 2, 3}}},
            {"boundary", json::object()}};
  for (int i = 0; i < 10'000; ++i) mesh["boundary"]["p" + std::to_string(i)] = {{0, 1}};
  json problem = membrane_on(mesh, json::object());
  problem["boundary"] = {{"all", {{"type", "fixed"}}}};
  EXPECT_EQ(found_soon(problem), "/domain/boundary");
}

/// As many as are looked at, of which the boxes of all edges meet.
TEST(Budget, ManySliversAreLeftToTheSolve) {
  for (const bool around_a_point : {false, true}) {
    json mesh{{"type", "mesh"}, {"points", json::array()}, {"triangles", json::array()}};
    const int count = 990;
    if (around_a_point) mesh["points"].push_back({0, 0});
    for (int i = 0; i < count; ++i) {
      const double x = 1e-3 * i, angle = 2 * std::numbers::pi * i / count, width = 0.3 / count;
      const int next = static_cast<int>(mesh["points"].size());
      if (around_a_point) {
        for (const double at : {angle, angle + width}) mesh["points"].push_back({std::cos(at), std::sin(at)});
        mesh["triangles"].push_back({0, next, next + 1});
        for (const auto& edge : {std::pair(0, next), std::pair(next, next + 1), std::pair(next + 1, 0)})
          mesh["boundary"]["rim"].push_back({edge.first, edge.second});
      } else {
        for (const auto& [dx, dy] : {std::pair(0., 0.), std::pair(3e-4, 0.), std::pair(10., 10.)})
          mesh["points"].push_back({x + dx, dy});
        mesh["triangles"].push_back({next, next + 1, next + 2});
        for (int e = 0; e < 3; ++e) mesh["boundary"]["rim"].push_back({next + e, next + (e + 1) % 3});
      }
    }
    json problem = membrane_on(mesh, json::object());
    problem["boundary"] = {{"rim", {{"type", "fixed"}}}};
    EXPECT_EQ(found_soon(problem), "");
  }
}

TEST(Budget, AStudyCountsItsMeshesByOnePolygon) {
  json problem = polygon(ring(9990), {{"size", 0.1}});
  for (int i = 0; i < 64; ++i) problem["study"]["sizes"].push_back(0.03 + 0.001 * i);
  EXPECT_EQ(found_soon(problem), "");
}

/// The exact counts of small meshes stand beside it in other tests.
TEST(Budget, TheMeasuredSizesAreNearTheMade) {
  for (const double size : {0.03, 0.015}) {
    const Problem problem = parse_request(polygon(ring(100), {{"size", size}}).dump()).problem;
    const auto predicted = static_cast<double>(estimate(problem).triangles);
    const auto made = static_cast<double>(solve(problem, {ActiveSet{}, {}}).summary.triangles);
    EXPECT_GE(predicted, made) << size;
    EXPECT_LE(predicted, 2 * made) << size;
  }
}

}  // namespace
}  // namespace signorini::api::budget_test
