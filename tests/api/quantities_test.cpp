// The member `quantities` of a problem and of a result.
#include <map>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/document/json_document.hpp"
#include "api/problem/problem_json.hpp"
#include "api/result/csv.hpp"
#include "api/result/result_document.hpp"
#include "api/result/result_table.hpp"

namespace signorini::api::quantities_test {
namespace {

using nlohmann::json;

json body(const json& quantities) {
  return {{"model", "elasticity"},
          {"domain", {{"type", "rectangle"}, {"size", {2, 1}}}},
          {"mesh", {{"divisions", {4, 2}}}},
          {"material", {{"young", 200}, {"poisson", 0.3}}},
          {"boundary",
           {{"top", {{"type", "fixed"}}},
            {"left", {{"type", "traction"}, {"pressure", 1}}},
            {"bottom", {{"type", "contact"}, {"gap", 0.01}}}}},
          {"scheme", "conforming"},
          {"quantities", quantities}};
}

Quantity read(const json& quantity) {
  return parse_request(body(json::array({quantity})).dump()).problem.quantities.at(0);
}

double weight_at(const json& weight, double x) {
  const json quantity{{"name", "w"}, {"type", "pressure_force"}, {"part", "bottom"}, {"weight", weight}};
  return read(quantity).weights.at("bottom")(Point(x, 0));
}

TEST(ReadQuantities, WeightsAreWhatTheirPointsSay) {
  const json hat = {{"hat", {{0.5, 0}, {1, 0}, {2, 0}}}};
  for (const auto& [x, w] :
       std::map<double, double>{{0, 0}, {0.5, 0}, {0.75, 0.5}, {1, 1}, {1.5, 0.5}, {2, 0}})
    EXPECT_NEAR(weight_at(hat, x), w, 1e-14) << x;
  const json trapezoid = {{"trapezoid", {{0, 0}, {0.5, 0}, {1, 0}, {2, 0}}}};
  for (const auto& [x, w] :
       std::map<double, double>{{0, 0}, {0.25, 0.5}, {0.5, 1}, {0.8, 1}, {1.5, 0.5}, {2, 0}})
    EXPECT_NEAR(weight_at(trapezoid, x), w, 1e-14) << x;
  const json linear = {{"linear", {{0, 0, 3}, {2, 0, -1}}}};
  for (const auto& [x, w] : std::map<double, double>{{0, 3}, {1, 1}, {2, -1}})
    EXPECT_NEAR(weight_at(linear, x), w, 1e-14) << x;
  EXPECT_EQ(
      read({{"name", "f"}, {"type", "pressure_force"}, {"part", "bottom"}}).weights.at("bottom")(Point(1, 0)),
      1);
}

TEST(ReadQuantities, ReactionsAreMotionsOfTheirSupport) {
  const Quantity force = read({{"name", "f"}, {"type", "reaction"}, {"part", "top"}, {"direction", {0, -5}}});
  EXPECT_EQ(force.motions.at("top").translation, Vector(0, -1));
  EXPECT_EQ(force.motions.at("top").rotation, 0);
  const Quantity moment = read({{"name", "m"}, {"type", "reaction"}, {"part", "top"}, {"about", {2, 3}}});
  // x ↦ (3 − y, x − 2): no motion in the point itself.
  EXPECT_EQ(moment.motions.at("top").translation, Vector(3, -2));
  EXPECT_EQ(moment.motions.at("top").rotation, 1);
}

TEST(ReadQuantities, MeansHaveADensity) {
  const Quantity side =
      read({{"name", "u"}, {"type", "mean_displacement"}, {"part", "left"}, {"direction", {3, 4}}});
  EXPECT_TRUE(side.is_mean);
  EXPECT_NEAR(side.densities.at("left")(0, Point(0, 0)), 0.6, 1e-15);
  EXPECT_NEAR(side.densities.at("left")(1, Point(0, 0)), 0.8, 1e-15);
  const Quantity disc = read({{"name", "d"},
                              {"type", "mean_displacement"},
                              {"disc", {{"centre", {1, 0.5}}, {"radius", 0.25}}},
                              {"direction", {1, 0}}});
  EXPECT_NEAR(disc.density(0, Point(1.1, 0.6)), 16 / std::numbers::pi, 1e-12);
  EXPECT_EQ(disc.density(0, Point(1.3, 0.5)), 0);
  EXPECT_EQ(disc.disc->radius, 0.25);
}

/// Whatever corner it begins with and whichever way it goes around.
TEST(ReadQuantities, MeansOverAPolygonHaveADensityInsideAlone) {
  const std::vector<Point> corners{{1.2, 0.2}, {1.2, 0.4}, {0.4, 0.4}, {0.4, 0.8}, {0.2, 0.8}, {0.2, 0.2}};
  for (const bool reversed : {false, true})
    for (std::size_t first = 0; first < corners.size(); ++first) {
      json points;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point& x = corners[(first + (reversed ? corners.size() - i : i)) % corners.size()];
        points.push_back({x.x(), x.y()});
      }
      const Quantity mean =
          read({{"name", "m"}, {"type", "mean_displacement"}, {"polygon", points}, {"direction", {0, 1}}});
      for (const Point& inside : {Point(0.3, 0.7), Point(0.25, 0.3), Point(1.1, 0.3)})
        EXPECT_NEAR(mean.density(1, inside), 1 / 0.28, 1e-12) << first;
      for (const Point& outside : {Point(0.5, 0.5), Point(0.1, 0.3), Point(1.1, 0.41), Point(0.7, 0.1)})
        EXPECT_NEAR(mean.density(1, outside), 0, 1e-12) << first;
      EXPECT_EQ(mean.outline->corners.size(), 6u);
    }
}

TEST(ReadQuantities, OpeningsHaveAWeight) {
  EXPECT_EQ(read({{"name", "o"}, {"type", "opening"}, {"part", "bottom"}}).openings.at("bottom")(Point(1, 0)),
            1);
}

/// The pointers of the faults.
std::vector<std::string> faults(const json& quantities) {
  std::vector<std::string> pointers;
  try {
    parse_request(body(quantities).dump());
  } catch (const InvalidProblem& invalid) {
    for (const Fault& fault : invalid.faults()) pointers.push_back(fault.where);
  }
  return pointers;
}

TEST(ReadQuantities, FaultsHaveTheirPlace) {
  const std::vector<std::pair<json, std::string>> cases{
      {{{"name", "f"}, {"type", "pressure_force"}, {"part", "botom"}}, "/part"},
      {{{"name", "f"}, {"type", "pressure_force"}, {"part", "top"}}, "/part"},
      {{{"name", "f"}, {"type", "pressure_force"}}, "/part"},
      {{{"name", ""}, {"type", "pressure_force"}, {"part", "bottom"}}, "/name"},
      {{{"type", "pressure_force"}, {"part", "bottom"}}, "/name"},
      {{{"name", "f"}, {"type", "force"}, {"part", "bottom"}}, "/type"},
      {{{"name", "f"}, {"type", "pressure_force"}, {"part", "bottom"}, {"direction", {1, 0}}}, "/direction"},
      {{{"name", "f"}, {"type", "pressure_force"}, {"part", "bottom"}, {"weight", json::object()}},
       "/weight"},
      {{{"name", "f"},
        {"type", "pressure_force"},
        {"part", "bottom"},
        {"weight", {{"hat", {{0, 0}, {0, 0}, {1, 0}}}}}},
       "/weight/hat/1"},
      {{{"name", "f"},
        {"type", "pressure_force"},
        {"part", "bottom"},
        {"weight", {{"linear", {{0, 0, 1}, {0, 0, 2}}}}}},
       "/weight/linear"},
      {{{"name", "r"}, {"type", "reaction"}, {"part", "bottom"}, {"direction", {1, 0}}}, "/part"},
      {{{"name", "r"}, {"type", "reaction"}, {"part", "top"}}, "/part"},
      {{{"name", "r"}, {"type", "reaction"}, {"part", "top"}, {"direction", {0, 0}}}, "/direction"},
      {{{"name", "r"}, {"type", "reaction"}}, "/part"},
      {{{"name", "r"}, {"type", "reaction"}, {"direction", {1, 0}}, {"about", {0, 0}}}, "/part"},
      {{{"name", "f"},
        {"type", "pressure_force"},
        {"part", "bottom"},
        {"weight", {{"hat", {{0, 0}, {1e-300, 0}, {1, 0}}}}}},
       "/weight/hat/1"},
      {{{"name", "f"},
        {"type", "pressure_force"},
        {"part", "bottom"},
        {"weight", {{"trapezoid", {{0, 0}, {1, 0}, {2, 0}, {1e300, 0}}}}}},
       "/weight/trapezoid/3"},
      {{{"name", "f"},
        {"type", "pressure_force"},
        {"part", "bottom"},
        {"weight", {{"linear", {{0, 0, 1e308}, {1, 0, -1e308}}}}}},
       "/weight/linear"},
      {{{"name", "u"},
        {"type", "mean_displacement"},
        {"disc", {{"centre", {1, 0.5}}, {"radius", 1e300}}},
        {"direction", {1, 0}}},
       "/disc/radius"},
      {{{"name", "u"}, {"type", "mean_displacement"}, {"part", "top"}, {"direction", {1, 0}}}, "/part"},
      {{{"name", "u"}, {"type", "mean_displacement"}, {"part", "left"}}, "/direction"},
      {{{"name", "u"}, {"type", "mean_displacement"}, {"direction", {1, 0}}}, "/part"},
      {{{"name", "u"},
        {"type", "mean_displacement"},
        {"disc", {{"centre", {1, 0.5}}, {"radius", 0}}},
        {"direction", {1, 0}}},
       "/disc/radius"},
      {{{"name", "u"}, {"type", "mean_displacement"}, {"polygon", {{0, 0}, {1, 1}}}, {"direction", {1, 0}}},
       "/polygon"},
      {{{"name", "u"},
        {"type", "mean_displacement"},
        {"polygon", {{0, 0}, {1, 1}, {2, 2}}},
        {"direction", {1, 0}}},
       "/polygon"},
      {{{"name", "o"}, {"type", "opening"}, {"part", "top"}}, "/part"}};
  for (const auto& [quantity, place] : cases)
    EXPECT_EQ(faults(json::array({quantity})), std::vector{"/quantities/0" + place}) << quantity;
  const json force{{"name", "f"}, {"type", "pressure_force"}, {"part", "bottom"}};
  EXPECT_EQ(faults({force, force}), std::vector<std::string>{"/quantities/1/name"});
  EXPECT_EQ(faults(json::array()), std::vector<std::string>{});
  EXPECT_EQ(faults(json(std::vector<json>(101, force))), std::vector<std::string>{"/quantities"});
}

TEST(ReadQuantities, AGoalIsOneOfThem) {
  json document = body({{{"name", "f"}, {"type", "pressure_force"}, {"part", "bottom"}}});
  document["mesh"] = {{"adaptive", {{"tolerance", 0.1}, {"quantity", "f"}}}};
  EXPECT_EQ(parse_request(document.dump()).problem.mesh.adaptive->quantity, "f");
  document["mesh"]["adaptive"]["quantity"] = "g";
  try {
    parse_request(document.dump());
    FAIL();
  } catch (const InvalidProblem& invalid) {
    EXPECT_EQ(invalid.faults().front().where, "/mesh/adaptive/quantity");
  }
}

Solution solution_with_quantities() {
  Solution solution;
  EnclosedQuantity known, unknown;
  known.name = "grip";
  known.value = 0.40029;
  known.estimate = 0.3997;
  known.lower = 0.39914;
  known.upper = 0.40025;
  known.guaranteed = true;
  unknown.name = "=total";
  unknown.value = unknown.estimate = 3;
  unknown.unmet = {"it touches beside a support"};
  solution.summary.quantities = {known, unknown};
  return solution;
}

std::string written(const std::function<bool(const Sink&)>& write) {
  std::string text;
  write([&](std::string_view piece) {
    text += piece;
    return true;
  });
  return text;
}

TEST(WriteQuantities, AreAMemberOfTheResult) {
  const Solution solution = solution_with_quantities();
  const json document = json::parse(written([&](const Sink& sink) {
    return write_document(Format::json, sink, [&](DocumentWriter& out) {
      write_result(out, {{}, "succeeded", "{}"}, solution, ResultFields::parse("quantities"));
    });
  }));
  EXPECT_EQ(document["quantities"], json::parse(R"([
    {"name": "grip", "value": 0.40029, "estimate": 0.3997, "lower": 0.39914, "upper": 0.40025, "guaranteed": true},
    {"name": "=total", "value": 3.0, "estimate": 3.0, "guaranteed": false, "unmet": ["it touches beside a support"]}])"));
}

TEST(WriteQuantities, AreATable) {
  const Solution solution = solution_with_quantities();
  EXPECT_EQ(
      written([&](const Sink& sink) { return write_quantities_csv(solution.summary.quantities, sink); }),
      "name,value,estimate,lower,upper,guaranteed\r\n"
      "grip,0.40029,0.3997,0.39914,0.40025,true\r\n"
      "'=total,3,3,,,false\r\n");
  const std::string table = written([&](const Sink& sink) { return write_result_table("", solution, sink); });
  EXPECT_NE(table.find("grip        0.3997  0.39914  0.40025      guaranteed"), std::string::npos) << table;
  EXPECT_NE(table.find("it touches beside a support"), std::string::npos) << table;
}

}  // namespace
}  // namespace signorini::api::quantities_test
