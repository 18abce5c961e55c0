#include "api/result/vtu.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "read_vtu.hpp"
#include "written_by.hpp"

namespace signorini::api::vtu_test {
namespace {

using testing::ElementsAre;

/// A square of two triangles, whose numbers tell where they come from.
Solution two_triangles(int components, Scheme scheme) {
  Solution solution;
  solution.scheme = scheme;
  solution.components = components;
  solution.mesh = std::make_shared<const Mesh>(
      make_mesh({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}, {"left", "other"},
                {{{3, 0}, 0}, {{0, 1}, 1}, {{1, 2}, 1}, {{2, 3}, 1}}));
  const int values = (scheme == Scheme::conforming ? 3 : 1) * components;
  solution.displacement = Eigen::VectorXd::LinSpaced(2 * values, 1, 2 * values).reshaped(values, 2);
  solution.displacement_at_points =
      Eigen::VectorXd::LinSpaced(4 * components, 101, 100 + 4 * components).reshaped(components, 4);
  const int entries = components + 1;
  solution.stress_at_centroids =
      Eigen::VectorXd::LinSpaced(2 * entries, 201, 200 + 2 * entries).reshaped(entries, 2);
  if (components == 2) solution.out_of_plane_stress = Eigen::Vector2d(301, 302);
  return solution;
}

std::string file_of(const Solution& solution) {
  return written_by([&](const Sink& sink) { return write_vtu(solution, sink); });
}

/// The rows of the triangles, or of their corners, which come before those of the lines.
template <typename Number>
std::vector<Number> of_triangles(const std::vector<Number>& values, std::size_t count) {
  EXPECT_GT(values.size(), count);
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count)};
}

std::vector<std::string> names_of(const Vtu& vtu, const std::string& section) {
  std::vector<std::string> names;
  for (const auto& [name, array] : vtu.arrays)
    if (array.section == section) names.push_back(name);
  return names;
}

TEST(WriteVtu, DescribesAnUnstructuredGrid) {
  const Vtu vtu = read_vtu(file_of(two_triangles(2, Scheme::conforming)));
  EXPECT_TRUE(
      vtu.head.starts_with("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
                           "byte_order=\"LittleEndian\" header_type=\"UInt64\">"));
  EXPECT_NE(vtu.head.find("<Piece NumberOfPoints=\"14\" NumberOfCells=\"6\">"), std::string::npos);
  EXPECT_THAT(names_of(vtu, "PointData"), ElementsAre("displacement", "displacement_continuous"));
  EXPECT_THAT(names_of(vtu, "CellData"), ElementsAre("part", "stress", "von_mises"));
  EXPECT_THAT(names_of(vtu, "Points"), ElementsAre("Points"));
  EXPECT_THAT(names_of(vtu, "Cells"), ElementsAre("connectivity", "offsets", "types"));
}

TEST(WriteVtu, GivesEachTriangleItsOwnPoints) {
  Vtu vtu = read_vtu(file_of(two_triangles(1, Scheme::nonconforming)));
  EXPECT_THAT(of_triangles(vtu.arrays["Points"].doubles(), 18), ElementsAre(0, 0, 0, 2, 0, 0, 2, 1, 0,  //
                                                                            0, 0, 0, 2, 1, 0, 0, 1, 0));
  EXPECT_THAT(vtu.arrays["connectivity"].integers(),
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13));
  EXPECT_THAT(vtu.arrays["offsets"].integers(), ElementsAre(3, 6, 8, 10, 12, 14));
  EXPECT_EQ(vtu.arrays["types"].type, "UInt8");
  EXPECT_EQ(vtu.arrays["types"].bytes, "\5\5\3\3\3\3");
}

TEST(WriteVtu, GivesEachEdgeOfTheBoundaryALineWithItsPart) {
  Vtu vtu = read_vtu(file_of(two_triangles(1, Scheme::conforming)));
  EXPECT_THAT(vtu.arrays["part"].as<std::int32_t>(), ElementsAre(-1, -1, 0, 1, 1, 1));
  const std::vector<double> points = vtu.arrays["Points"].doubles();
  EXPECT_THAT(std::vector(points.begin() + 18, points.end()), ElementsAre(0, 1, 0, 0, 0, 0,  // 3, 0
                                                                          0, 0, 0, 2, 0, 0,  // 0, 1
                                                                          2, 0, 0, 2, 1, 0,  // 1, 2
                                                                          2, 1, 0, 0, 1, 0));
  const std::vector<double> displacement = vtu.arrays["displacement"].doubles();
  EXPECT_THAT(std::vector(displacement.begin() + 6, displacement.end()), ElementsAre(6, 4, 1, 2, 2, 3, 5, 6));
  const std::vector<double> stress = vtu.arrays["stress"].doubles();
  EXPECT_THAT(std::vector(stress.begin() + 6, stress.end()),
              ElementsAre(203, 204, 0, 201, 202, 0, 201, 202, 0, 203, 204, 0));
}

/// Not a number where there is no contact.
std::vector<std::string> in_words(const std::vector<double>& values) {
  std::vector<std::string> words;
  for (const double value : values)
    words.push_back(std::isnan(value) ? "-" : std::to_string(std::lround(value)));
  return words;
}

TEST(WriteVtu, GivesClearanceAndPressureOnTheLinesOfTheContact) {
  Solution solution = two_triangles(1, Scheme::nonconforming);
  solution.contact = {{"other", {{1, 0}, {2, 0.5}, {1, 1}}, {1, 2, 3}, {10, 20, 30}, {}, {}, {}}};
  Vtu p0 = read_vtu(file_of(solution));
  EXPECT_THAT(names_of(p0, "PointData"),
              ElementsAre("clearance", "displacement", "displacement_continuous", "pressure"));
  EXPECT_THAT(in_words(p0.arrays["clearance"].doubles()),
              ElementsAre("-", "-", "-", "-", "-", "-", "-", "-", "1", "1", "2", "2", "3", "3"));
  EXPECT_THAT(in_words(p0.arrays["pressure"].doubles()),
              ElementsAre("-", "-", "-", "-", "-", "-", "-", "-", "10", "10", "20", "20", "30", "30"));
  // A row a node, two where the direction of the contact turns.
  solution = two_triangles(1, Scheme::conforming);
  solution.contact = {
      {"other", {{0, 0}, {2, 0}, {2, 0}, {2, 1}, {0, 1}}, {1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}, {}, {}, {}}};
  EXPECT_THAT(in_words(read_vtu(file_of(solution)).arrays["pressure"].doubles()),
              ElementsAre("-", "-", "-", "-", "-", "-", "-", "-", "1", "2", "3", "4", "4", "5"));
}

TEST(WriteVtu, GivesTheDensityOfTheErrorBound) {
  Solution solution = two_triangles(1, Scheme::conforming);
  EXPECT_FALSE(read_vtu(file_of(solution)).arrays.contains("error_density"));
  solution.error_squares = Eigen::Vector2d(3, 5);
  EXPECT_THAT(read_vtu(file_of(solution)).arrays["error_density"].doubles(), ElementsAre(3, 5, 5, 3, 3, 5));
}

TEST(WriteVtu, KeepsTheDisplacementOfAMembraneDiscontinuous) {
  Vtu p0 = read_vtu(file_of(two_triangles(1, Scheme::nonconforming)));
  EXPECT_EQ(attribute(p0.arrays["displacement"].attributes, "NumberOfComponents"), "1");
  EXPECT_THAT(of_triangles(p0.arrays["displacement"].doubles(), 6), ElementsAre(1, 1, 1, 2, 2, 2));
  EXPECT_THAT(of_triangles(p0.arrays["displacement_continuous"].doubles(), 6),
              ElementsAre(101, 102, 103, 101, 103, 104));
  Vtu p1 = read_vtu(file_of(two_triangles(1, Scheme::conforming)));
  EXPECT_THAT(of_triangles(p1.arrays["displacement"].doubles(), 6), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(WriteVtu, KeepsTheDisplacementOfABodyDiscontinuous) {
  Vtu p0 = read_vtu(file_of(two_triangles(2, Scheme::nonconforming)));
  EXPECT_EQ(attribute(p0.arrays["displacement"].attributes, "NumberOfComponents"), "3");
  EXPECT_THAT(of_triangles(p0.arrays["displacement"].doubles(), 18),
              ElementsAre(1, 2, 0, 1, 2, 0, 1, 2, 0,  //
                          3, 4, 0, 3, 4, 0, 3, 4, 0));
  EXPECT_THAT(of_triangles(p0.arrays["displacement_continuous"].doubles(), 18),
              ElementsAre(101, 102, 0, 103, 104, 0, 105, 106, 0,  //
                          101, 102, 0, 105, 106, 0, 107, 108, 0));
  Vtu p1 = read_vtu(file_of(two_triangles(2, Scheme::conforming)));
  EXPECT_THAT(of_triangles(p1.arrays["displacement"].doubles(), 18),
              ElementsAre(1, 2, 0, 3, 4, 0, 5, 6, 0,  //
                          7, 8, 0, 9, 10, 0, 11, 12, 0));
}

TEST(WriteVtu, GivesTheStressOfAMembraneAsAVector) {
  Vtu vtu = read_vtu(file_of(two_triangles(1, Scheme::conforming)));
  EXPECT_EQ(attribute(vtu.arrays["stress"].attributes, "NumberOfComponents"), "3");
  EXPECT_THAT(of_triangles(vtu.arrays["stress"].doubles(), 6), ElementsAre(201, 202, 0, 203, 204, 0));
  EXPECT_FALSE(vtu.arrays.contains("von_mises"));
}

TEST(WriteVtu, GivesTheStressOfABodyWithTheEntryOutOfThePlane) {
  Solution solution = two_triangles(2, Scheme::nonconforming);
  Vtu vtu = read_vtu(file_of(solution));
  const Vtu::Array& stress = vtu.arrays["stress"];
  EXPECT_EQ(attribute(stress.attributes, "NumberOfComponents"), "6");
  EXPECT_EQ(attribute(stress.attributes, "ComponentName2"), "ZZ");
  EXPECT_EQ(attribute(stress.attributes, "ComponentName3"), "XY");
  EXPECT_THAT(of_triangles(stress.doubles(), 12),
              ElementsAre(201, 202, 301, 203, 0, 0, 204, 205, 302, 206, 0, 0));

  solution.stress_at_centroids.col(0) << 7, 7, 0;  // with σ_zz = 7 a pressure, with 0 none
  solution.out_of_plane_stress << 7, 302;
  EXPECT_EQ(read_vtu(file_of(solution)).arrays["von_mises"].doubles()[0], 0);
}

TEST(WriteVtu, LaysTheArraysSideBySide) {
  for (const int components : {1, 2}) {
    const Vtu vtu = read_vtu(file_of(two_triangles(components, Scheme::conforming)));
    std::map<std::uint64_t, std::uint64_t> blocks;
    for (const auto& [name, array] : vtu.arrays)
      blocks[array.offset] = sizeof(std::uint64_t) + array.bytes.size();
    std::uint64_t end = 0;
    for (const auto& [offset, size] : blocks) {
      EXPECT_EQ(offset, end);
      end = offset + size;
    }
    EXPECT_EQ(end, vtu.data.size());
  }
}

/// What a reader of the offsets like meshio's needs: see order_of_data in api/result/vtu.cpp.
TEST(WriteVtu, DescribesTheArraysFromTheLastToTheFirst) {
  const std::string head = read_vtu(file_of(two_triangles(2, Scheme::conforming))).head;
  std::vector<std::uint64_t> offsets;
  const std::regex offset("offset=\"([0-9]+)\"");
  for (std::sregex_iterator i(head.begin(), head.end(), offset), end; i != end; ++i)
    offsets.push_back(std::stoull((*i)[1]));
  EXPECT_EQ(offsets.size(), 9u);
  EXPECT_TRUE(std::ranges::is_sorted(offsets, std::greater()));
}

TEST(WriteVtu, KeepsEveryBitOfANumber) {
  Solution solution = two_triangles(1, Scheme::nonconforming);
  solution.displacement << -0.1, 5e-324;
  EXPECT_THAT(of_triangles(read_vtu(file_of(solution)).arrays["displacement"].doubles(), 6),
              ElementsAre(-0.1, -0.1, -0.1, 5e-324, 5e-324, 5e-324));
}

TEST(WriteVtu, ComesInPiecesAndStopsWhenNobodyReads) {
  Solution solution = two_triangles(1, Scheme::nonconforming);
  Mesh large = *solution.mesh;
  large.triangles.assign(20'000, {0, 1, 2});
  solution.mesh = std::make_shared<const Mesh>(std::move(large));
  solution.displacement = Eigen::RowVectorXd::Constant(20'000, 0.5);
  solution.stress_at_centroids = Eigen::Matrix2Xd::Zero(2, 20'000);
  EXPECT_EQ(read_vtu(file_of(solution)).arrays["displacement"].doubles().size(), 60'008u);
  int pieces = 0;
  EXPECT_FALSE(write_vtu(solution, [&](std::string_view) { return ++pieces < 3; }));
  EXPECT_EQ(pieces, 3);
}

}  // namespace
}  // namespace signorini::api::vtu_test
