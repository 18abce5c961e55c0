#include "api/picture/picture.hpp"

#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <boost/property_tree/xml_parser.hpp>

#include "api/picture/colour_map.hpp"
#include "written_by.hpp"

namespace signorini::api::picture_test {
namespace {

/// A rectangle of two triangles, 2 by 1.
Solution two_triangles(int components, const Eigen::MatrixXd& displacement) {
  Solution solution;
  solution.components = components;
  solution.mesh = std::make_shared<const Mesh>(
      make_mesh({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}, {"left", "other"},
                {{{3, 0}, 0}, {{0, 1}, 1}, {{1, 2}, 1}, {{2, 3}, 1}}));
  solution.displacement = displacement;
  solution.displacement_at_points = Eigen::MatrixXd::Zero(components, 4);
  solution.stress_at_centroids = Eigen::MatrixXd::Ones(components + 1, 2);
  if (components == 2) solution.out_of_plane_stress = Eigen::Vector2d::Zero();
  return solution;
}

/// The picture, which must be XML.
std::string drawn(const Solution& solution, const Picture& picture = {}) {
  picture.require_available(solution);
  const std::string text =
      written_by([&](const Sink& sink) { return write_picture(solution, picture, sink); });
  std::istringstream stream(text);
  boost::property_tree::ptree tree;
  EXPECT_NO_THROW(boost::property_tree::read_xml(stream, tree)) << text;
  return text;
}

/// The corners of the shapes in a path, which are written as steps.
std::vector<std::vector<Point>> shapes_of(const std::string& path) {
  std::vector<std::vector<Point>> all;
  const std::regex number("-?[0-9.]+");
  Point corner(0, 0);
  std::istringstream shapes(path);
  for (std::string shape; std::getline(shapes, shape, 'M');) {
    corner.setZero();
    std::vector<Point>& corners = all.emplace_back();
    for (std::sregex_iterator c(shape.begin(), shape.end(), number), end; c != end; ++c) {
      const double x = std::stod(c->str());
      corners.push_back(corner += Vector(x, std::stod((++c)->str())));
    }
  }
  return all;
}

/// The area that each band of colour has on the body, in pixels, from the shapes of the paths.
std::map<int, double> areas(const std::string& svg) {
  std::map<int, double> all;
  const std::regex path("<path class=\"f c([0-9]+)\" d=\"([^\"]*)\"");
  for (std::sregex_iterator p(svg.begin(), svg.end(), path), end; p != end; ++p)
    for (const std::vector<Point>& corners : shapes_of((*p)[2])) {
      double area = 0;
      for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point &a = corners[i], &b = corners[(i + 1) % corners.size()];
        area += (a.x() * b.y() - a.y() * b.x()) / 2;
      }
      all[std::stoi((*p)[1])] += std::abs(area);
    }
  return all;
}

/// 580 pixels for a length of 2.
constexpr double area_of_picture = 580 * 290;

TEST(Picture, ShowsOneColourInEachTriangleOfAConstantField) {
  const std::map<int, double> bands = areas(drawn(two_triangles(1, Eigen::RowVector2d(1, 3))));
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_NEAR(bands.at(0), area_of_picture / 2, 1);
  EXPECT_NEAR(bands.at(ColourMap::kBands - 1), area_of_picture / 2, 1);
}

/// u = x is as often in each band as in any other.
TEST(Picture, ShowsBandsOfALinearField) {
  Eigen::MatrixXd linear(3, 2);
  linear << 0, 0, 2, 2, 2, 0;
  const std::map<int, double> bands = areas(drawn(two_triangles(1, linear)));
  ASSERT_EQ(bands.size(), static_cast<std::size_t>(ColourMap::kBands));
  for (const auto& [band, area] : bands) EXPECT_NEAR(area, area_of_picture / ColourMap::kBands, 3) << band;
}

/// |u| is 1 in one triangle and jumps to 2.
TEST(Picture, KeepsJumps) {
  Eigen::MatrixXd jump(6, 2);
  jump << 1, 0, 0, 2, 1, 0, 0, -2, 1, 0, 0, 2;
  const std::map<int, double> bands = areas(drawn(two_triangles(2, jump)));
  ASSERT_EQ(bands.size(), 2u);
  EXPECT_NEAR(bands.begin()->second, area_of_picture / 2, 1);
}

/// The rectangle of 2 × 1 has five edges, its diagonal among them.
TEST(Picture, FollowsEachEdgeOnce) {
  const std::string svg = drawn(two_triangles(1, Eigen::RowVector2d(1, 3)));
  std::smatch mesh;
  ASSERT_TRUE(std::regex_search(svg, mesh, std::regex("<path class=\"mesh\" d=\"([^\"]*)\"")));
  double length = 0;
  for (const std::vector<Point>& line : shapes_of(mesh[1]))
    for (std::size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  EXPECT_NEAR(length, 290 * (2 + 1 + 2 + 1 + std::sqrt(5)), 0.1);
}

TEST(Picture, HasNoColourForSignsThatAreNotThere) {
  EXPECT_EQ(ColourMap(-1, 3).low(), -3);
  EXPECT_EQ(ColourMap(-1, 3).colour(0), "#2166ac");
  EXPECT_EQ(ColourMap(-1e-3, 3).low(), -1e-3);
  EXPECT_EQ(ColourMap(-3, 1e-3).high(), 1e-3);
  EXPECT_EQ(ColourMap(1, 3).low(), 1);
  EXPECT_EQ(ColourMap(1, 3).colour(0), "#440154");
  EXPECT_EQ(ColourMap(1, 3).colour(ColourMap::kBands - 1), "#fde725");
  // One value, but for rounding.
  EXPECT_EQ(ColourMap(3, 3 + 4e-15).band(3), ColourMap(3, 3 + 4e-15).band(3 + 4e-15));
  EXPECT_EQ(ColourMap(3, 3).start_of(ColourMap::kBands / 2), 3);
  EXPECT_EQ(ColourMap(0, 0).low(), -1);
  EXPECT_EQ(ColourMap(-1.7e308, 1.7e308).band(1.7e308), ColourMap::kBands - 1);
}

TEST(Picture, MovesThePointsOfABody) {
  Solution solution = two_triangles(2, Eigen::MatrixXd::Ones(2, 2));
  solution.displacement_at_points << 0, 1, 1, 0, 0, 0, 0, 0;  // twice as long if moved twice
  Picture picture;
  EXPECT_NE(drawn(solution, picture).find("height=\"374\""), std::string::npos);
  picture.deformed = 2;
  const std::map<int, double> bands = areas(drawn(solution, picture));
  EXPECT_NEAR(bands.begin()->second, 580 * 145, 2);
  picture.deformed = 1e200;
  EXPECT_THROW(drawn(solution, picture), InvalidProblem);
}

TEST(Picture, ShowsStresses) {
  Solution solution = two_triangles(2, Eigen::MatrixXd::Ones(2, 2));
  solution.stress_at_centroids << 1, 0, -5, 0, 0, 2;  // principal stresses 1 and −5, ±2
  const std::string principal = drawn(solution, {Picture::Field::stress, {}});
  EXPECT_NE(principal.find(">-5</text>"), std::string::npos) << principal;
  EXPECT_NE(principal.find(">5</text>"), std::string::npos);
  const std::string equivalent = drawn(solution, {Picture::Field::von_mises, {}});
  EXPECT_NE(equivalent.find(">5.57</text>"), std::string::npos);  // √31
  EXPECT_NE(equivalent.find(">3.46</text>"), std::string::npos);  // √12
}

TEST(Picture, RefusesWhatIsNotThere) {
  const Solution membrane = two_triangles(1, Eigen::RowVector2d(1, 3));
  const auto where = [&](const Picture& picture) -> std::string {
    try {
      picture.require_available(membrane);
    } catch (const InvalidProblem& invalid) {
      return invalid.faults().front().where;
    }
    return "";
  };
  EXPECT_EQ(where({Picture::Field::von_mises, {}}), "/field");
  EXPECT_EQ(where({Picture::Field::error, {}}), "/field");
  EXPECT_EQ(where({Picture::Field::displacement, 2}), "/deformed");
  EXPECT_EQ(where({Picture::Field::history, 2}), "/deformed");
  EXPECT_EQ(where({Picture::Field::stress, {}}), "");
  EXPECT_EQ(Picture::field_named(""), Picture::Field::displacement);
  try {
    Picture::field_named("stres");
    ADD_FAILURE();
  } catch (const InvalidProblem& invalid) {
    EXPECT_NE(invalid.faults().front().detail.find("did you mean \"stress\""), std::string::npos)
        << invalid.faults().front().detail;
  }
}

TEST(Picture, OfTheContactMarksWhereItTouchesAndKeepsNamesText) {
  Solution solution = two_triangles(1, Eigen::RowVector2d(1, 3));
  solution.contact = {{"<script>alert(1)</script> & co",
                       {{0, 0}, {1, 0}, {2, 0}, {3, 0}},
                       {0, 0, 0.5, 1},
                       {2, 1, 0, 0},
                       {0, 0, 0, 0},
                       {1, 1, 1, 1},
                       {false, false, true, true}}};
  const std::string svg = drawn(solution, {Picture::Field::contact, {}});
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_NE(svg.find("&lt;script&gt;alert(1)&lt;/script&gt; &amp; co: pressure"), std::string::npos);
  // 620 pixels for a length of 3; rows 0 and 1 touch, with half a length beyond the last: one strip in each
  // plot.
  const std::string strip = "<rect class=\"closed\" x=\"70\" y=\"40\" width=\"310\" height=\"150\"/>";
  EXPECT_NE(svg.find(strip), std::string::npos) << svg;
  solution.contact[0].name = "]]>\xef\xbf\xbf\x01 \xc3\xa9";
  EXPECT_NE(drawn(solution, {Picture::Field::contact, {}}).find(">]]&gt; \xc3\xa9: pressure"),
            std::string::npos);
  EXPECT_NE(drawn(two_triangles(1, Eigen::RowVector2d(1, 3)), {Picture::Field::contact, {}}).find("No part"),
            std::string::npos);
}

/// The corners of the lines of the foundation.
std::vector<std::vector<Point>> foundation_of(const std::string& svg) {
  std::smatch path;
  if (!std::regex_search(svg, path, std::regex("<path class=\"foundation\" d=\"([^\"]*)\""))) return {};
  std::vector<std::vector<Point>> lines = shapes_of(path[1]);
  lines.erase(lines.begin());  // before the first M
  return lines;
}

/// The lower side of the rectangle, 2 long, as a contact of one edge with two nodes.
Solution with_foundation(double left, double right) {
  Solution solution = two_triangles(2, Eigen::MatrixXd::Ones(2, 2));
  solution.contact = {{"other", {{0, 0}, {2, 0}}, {0, 0}, {0, 0}, {left, right}, {1, 1}, {true, true}}};
  return solution;
}

/// 290 pixels for a length of 1, the lower side at 344.
TEST(Picture, OfABodyHasTheFoundationWhereTheGapIs) {
  const std::vector<std::vector<Point>> lines = foundation_of(drawn(with_foundation(0, 0.1)));
  ASSERT_EQ(lines.size(), 1u);
  ASSERT_EQ(lines[0].size(), 2u);
  EXPECT_NEAR(lines[0][0].x(), 30, 0.01);
  EXPECT_NEAR(lines[0][0].y(), 344, 0.01);
  EXPECT_NEAR(lines[0][1].x(), 610, 0.01);
  EXPECT_NEAR(lines[0][1].y(), 344 + 29, 0.01);
}

TEST(Picture, MovesTheFoundationAsTheBody) {
  Picture picture;
  picture.deformed = 3;
  const auto lines = foundation_of(drawn(with_foundation(0, 0.1), picture));
  EXPECT_NEAR(lines.at(0).at(1).y(), 344 + 3 * 29, 0.01);
}

/// Along (1, −1)/√2.
TEST(Picture, LaysTheFoundationInTheDirectionOfTheContact) {
  Picture picture;
  picture.contacts["other"].direction = Vector(5, -5);
  const std::vector<Point> line = foundation_of(drawn(with_foundation(0.1, 0.1), picture)).at(0);
  const double scale = (line[1].x() - line[0].x()) / 2;
  EXPECT_LT(scale, 290) << "the picture has the foundation in it";
  EXPECT_NEAR(line[1].x(), 610, 0.01);
  EXPECT_NEAR(line[0].x(), 30 + 0.1 / std::sqrt(2) * scale, 0.02);
}

TEST(Picture, LeavesOutWhatIsFarFromTheBodyAndWhatAMembraneMeets) {
  const auto lines = foundation_of(drawn(with_foundation(0, 1e9)));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 1u);
  Solution membrane = two_triangles(1, Eigen::RowVector2d(1, 3));
  membrane.contact = with_foundation(0, 0.1).contact;
  EXPECT_TRUE(foundation_of(drawn(membrane)).empty());
}

TEST(Picture, OfTheHistoryHasACurveForEachResidualThatIsNotZero) {
  Solution solution = two_triangles(1, Eigen::RowVector2d(1, 3));
  for (int i = 1; i <= 3; ++i) {
    Iteration row;
    row.number = i;
    row.penetration = std::pow(10, -i);
    row.clearance_change = i == 2 ? 0 : std::pow(10, 1 - i);  // no logarithm in between
    solution.history.push_back(row);
  }
  const std::string svg = drawn(solution, {Picture::Field::history, {}});
  EXPECT_NE(svg.find(">penetration</text>"), std::string::npos);
  EXPECT_EQ(svg.find(">equilibrium</text>"), std::string::npos);
  EXPECT_NE(svg.find(">1e-2</text>"), std::string::npos) << svg;
  EXPECT_NO_THROW(drawn(two_triangles(1, Eigen::RowVector2d(1, 3)), {Picture::Field::history, {}}));
}

/// As on a mesh that refines itself, where a level may begin and end without a residual.
TEST(Picture, OfAHistoryLeavesOutWhatIsZero) {
  Solution solution = two_triangles(1, Eigen::RowVector2d(1, 3));
  for (const double penetration : {0., 0., 0.25, 0.5, 0., 0.}) {
    Iteration row{};
    row.number = static_cast<int>(solution.history.size()) + 1;
    row.penetration = penetration;
    solution.history.push_back(row);
  }
  const std::string svg = drawn(solution, {Picture::Field::history, {}});
  const std::size_t path = svg.find("<path class=\"curve c1\" d=\"M");
  ASSERT_NE(path, std::string::npos) << svg;
  const std::string curve = svg.substr(path, svg.find("/>", path) - path);
  EXPECT_EQ(std::ranges::count(curve, 'M'), 1) << curve;
}

}  // namespace
}  // namespace signorini::api::picture_test
