// Files of Gmsh: both versions give the same mesh; what is no such file is refused with the line.
#include "api/problem/gmsh.hpp"

#include <gtest/gtest.h>

#include "mesh/import.hpp"

namespace signorini::api::gmsh_test {
namespace {

/// Two triangles on the unit square, as Gmsh writes them; node 9 is the centre of nothing.
const std::string version2 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
1 5 "the floor"
1 6 "unused"
2 9 "body"
$EndPhysicalNames
$Nodes
5
9 7 7 0
1 0 0 0
20 1 0 0
3 1 1 0
4 0 1 0
$EndNodes
$Elements
8
1 15 2 0 1 1
2 1 2 5 1 1 20
3 1 2 7 2 20 3
4 1 2 7 3 3 4
5 1 2 7 4 4 1
6 1 2 0 5 1 3
7 2 2 9 1 1 20 3
8 2 2 9 1 1 3 4
$EndElements
)";

const std::string version4 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
1 5 "the floor"
2 9 "body"
$EndPhysicalNames
$Entities
1 4 1 0
1 0 0 0 0
1 0 0 0 1 0 0 1 -5 2 1 -2
2 1 0 0 1 1 0 1 7 2 2 -3
3 0 1 0 1 1 0 1 7 2 3 -4
4 0 0 0 0 1 0 1 7 2 4 -1
1 0 0 0 1 1 0 1 9 4 1 2 3 4
$EndEntities
$Nodes
3 4 1 20
0 1 0 1
1
0 0 0
1 1 1 1
20
1 0 0 0.5
2 1 0 2
3
4
1 1 0
0 1 0
$EndNodes
$Elements
6 7 1 7
0 1 15 1
1 1
1 1 1 1
2 1 20
1 2 1 1
3 20 3
1 3 1 1
4 3 4
1 4 1 1
5 4 1
2 1 2 2
6 1 20 3
7 1 3 4
$EndElements
$NodeData
whatever stands here
$EndNodeData
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

/// The only fault, with the pointer before it unless it is /domain/msh.
template <typename Read>
std::string fault_of(const std::string& text, Read read) {
  try {
    read(text);
  } catch (const InvalidProblem& invalid) {
    const Fault& fault = invalid.faults().front();
    return (fault.where == "/domain/msh" ? "" : fault.where) + fault.detail;
  }
  return "no fault";
}

void expect_square(const MeshData& data) {
  EXPECT_EQ(data.points, (std::vector<Point>{{0, 0}, {1, 0}, {1, 1}, {0, 1}}));
  EXPECT_EQ(data.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}}));
  ASSERT_EQ(data.boundary.size(), 2u);
  EXPECT_EQ(data.boundary[0].first, "the floor");
  EXPECT_EQ(data.boundary[0].second, (std::vector<std::array<int, 2>>{{0, 1}}));
  EXPECT_EQ(data.boundary[1].first, "7");
  EXPECT_EQ(data.boundary[1].second, (std::vector<std::array<int, 2>>{{1, 2}, {2, 3}, {3, 0}}));
}

TEST(Gmsh, ReadsVersion2) {
  expect_square(parse_gmsh(version2));
}

TEST(Gmsh, ReadsVersion4) {
  expect_square(parse_gmsh(version4));
}

TEST(Gmsh, ReadsLinesThatEndAsOnWindows) {
  std::string text = version4;
  for (std::size_t at = 0; (at = text.find('\n', at)) != text.npos; at += 2) text.replace(at, 1, "\r\n");
  expect_square(parse_gmsh(text));
}

/// Number of partitions, then the partitions; those of which it is a ghost are negative.
TEST(Gmsh, ReadsThePartitionsOfVersion2) {
  std::string text = version2;
  for (const auto& [from, to] :
       {std::pair("2 1 2 5 1 1 20", "2 1 4 5 1 1 2 1 20"),
        std::pair("3 1 2 7 2 20 3", "3 1 6 7 2 3 1 -2 -7 20 3"),
        std::pair("4 1 2 7 3 3 4", "4 1 3 7 3 0 3 4"), std::pair("6 1 2 0 5 1 3", "6 1 5 0 5 2 1 2 1 3"),
        std::pair("7 2 2 9 1 1 20 3", "7 2 4 9 1 1 1 1 20 3"),
        std::pair("8 2 2 9 1 1 3 4", "8 2 5 9 1 2 2 -1 1 3 4")})
    text = replaced(text, from, to);
  expect_square(parse_gmsh(text));
}

TEST(Gmsh, ReadsGroupsOfEitherOrientation) {
  expect_square(parse_gmsh(replaced(version2, "3 1 2 7 2 20 3", "3 1 2 -7 2 20 3")));
}

std::string lifted(double z, double tilt = 0) {
  std::string text = version2;
  const auto node = [&](int tag, int x, int y) {
    const std::string at = std::to_string(tag) + ' ' + std::to_string(x) + ' ' + std::to_string(y) + ' ';
    text = replaced(text, '\n' + at + "0\n", '\n' + at + std::to_string(z + tilt * x) + '\n');
  };
  node(1, 0, 0);
  node(20, 1, 0);
  node(3, 1, 1);
  node(4, 0, 1);
  return text;
}

TEST(Gmsh, LeavesAConstantHeightOutAndSaysSo) {
  EXPECT_TRUE(parse_gmsh(version2).notes.empty());
  const MeshData data = parse_gmsh(lifted(-2.5));
  expect_square(data);
  ASSERT_EQ(data.notes.size(), 1u);
  EXPECT_NE(data.notes[0].find("z = -2.5"), std::string::npos) << data.notes[0];
  EXPECT_EQ(import_mesh(parse_gmsh(lifted(-2.5))).notes, data.notes);
}

TEST(Gmsh, RefusesAMeshInAnotherPlane) {
  EXPECT_NE(fault_of(lifted(0, 0.25), parse_gmsh).find("must be plane"), std::string::npos);
  std::string upright = version2;
  for (const auto& [from, to] :
       {std::pair("\n3 1 1 0\n", "\n3 1 0 1\n"), std::pair("\n4 0 1 0\n", "\n4 0 0 1\n")})
    upright = replaced(upright, from, to);
  const std::string fault = fault_of(upright, parse_gmsh);
  EXPECT_NE(fault.find("turn it into the plane of x and y"), std::string::npos) << fault;
}

TEST(Gmsh, TakesAGroupThatACurveNamesTwiceOnce) {
  expect_square(parse_gmsh(replaced(version4, "1 7 2 3 -4", "3 7 -7 7 2 3 -4")));
}

TEST(Gmsh, TakesSoManyGroupsAsAMeshHasParts) {
  std::string elements;
  const int groups = 12'001;
  for (int i = 1; i <= groups; ++i)
    elements += std::to_string(10 + i) + " 1 1 " + std::to_string(100 + i) + " 1 20\n";
  const std::string text =
      replaced(replaced(version2, "$Elements\n8", "$Elements\n" + std::to_string(8 + groups)), "$EndElements",
               elements + "$EndElements");
  const std::string fault = fault_of(text, parse_gmsh);
  EXPECT_NE(fault.find("the lines are in more than 12000 physical groups"), std::string::npos) << fault;
}

TEST(Gmsh, MakesAMesh) {
  const Mesh mesh = import_mesh(parse_gmsh(version4));
  EXPECT_DOUBLE_EQ(mesh.area(), 1);
  EXPECT_EQ(mesh.boundary[1].edges.size(), 3u);
}

TEST(Gmsh, StatesFaultsOfTheMeshAtTheFile) {
  const std::string text = replaced(version2, "3 1 2 7 2 20 3", "3 1 2 0 2 20 3");
  const std::string fault = fault_of(text, [](std::string_view file) { import_mesh(parse_gmsh(file)); });
  EXPECT_EQ(fault.find("boundary, counted from 0 in the file: no part has the edge 1-2"), 0u) << fault;
}

TEST(Gmsh, RefusesWhatItCannotReadWithTheLine) {
  struct Case {
    const std::string& text;
    std::string from, to, fault;
  };
  const std::vector<Case> cases{
      {version2, "$MeshFormat", "$Mesh", "line 1: expected $MeshFormat"},
      {version2, "2.2 0 8", "2.2 1 8", "line 2: a binary file"},
      {version4, "4.1 0 8", "4 0 8", "line 2: version \"4\""},
      {version2, "2.2 0 8", "3 0 8", "line 2: version \"3\""},
      {version2, "1 5 \"the floor\"", "1 5 the floor", "line 6: expected the name"},
      {version2, "1 5 \"the floor\"", "1 5 \"the floor", "line 6: expected the name"},
      {version2, "20 1 0 0", "20 1 nan 0", "line 14: expected a coordinate, a finite number, not \"nan\""},
      {version2, "20 1 0 0", "20 1 1e999 0", "line 14: expected a coordinate"},
      {version2, "20 1 0 0", "20 1 0x1 0", "line 14: expected a coordinate"},
      {version2, "20 1 0 0", "20.5 1 0 0", "line 14: expected the number of a node, a whole number"},
      {version2, "20 1 0 0", "3 1 0 0", "line 15: there are two nodes 3"},
      {version2, "20 1 0 0", "20 1 0 1e-3", "line 14: the z of node 20 is 0.001"},
      {version2, "$Nodes\n5", "$Nodes\n4000000000000", "line 11: the number of nodes is 4000000000000, but"},
      {version2, "$Nodes\n5", "$Nodes\n-5", "line 11: the number of nodes must not be negative"},
      {version2, "$Nodes\n5", "$Nodes\n4", "line 16: expected $EndNodes"},
      {version2, "$Nodes\n5", "$Nodes\n6", "line 17: expected the number of a node"},
      {version2, "$Nodes\n5", "$Nodes\n99999999999999999999", "line 11: expected the number of nodes"},
      {version2, "$Elements\n8", "$Elements\n9", "line 28: expected the number of an element"},
      {version2, "7 2 2 9 1 1 20 3", "7 3 2 9 1 1 20 3 4", "line 26: elements of type 3 (quadrangles)"},
      {version2, "7 2 2 9 1 1 20 3", "7 9 2 9 1 1 20 3 4 5 6", "line 26: elements of type 9 (second order)"},
      {version2, "7 2 2 9 1 1 20 3", "7 2 2 9 1 1 21 3", "line 26: there is no node 21"},
      {version2, "3 1 2 7 2 20 3", "3 1 2 7 2 20 9",
       "line 22: the line element's node 9 belongs to no triangle"},
      {version2, "7 2 2 9 1 1 20 3", "7 2 9999999 9 1 1 20 3", "line 26: the number of tags is 9999999"},
      {version2, "$Nodes", "Nodes", "line 10: expected a section"},
      {version2, "$EndElements", "$EndElements\n$Nodes\n0\n$EndNodes", "line 29: there is a second section"},
      {version4, "$Entities", "$Comments", "line 51: the text ends where there should be $EndComments"},
      {version4, "1 0 0 0.5", "1 0 0 x", "line 25: expected a parametric"},
      {version4, "3 4 1 20", "300000 4 1 20", "line 19: the number of blocks is 300000"},
      {version4, "2 1 0 2", "2 1 0 1000000", "line 26: the number of nodes is 1000000"},
      {version4, "2 1 2 2", "2 1 3 2", "line 44: elements of type 3 (quadrangles)"},
      {version4, "1 4 1 0", "1 4 1 987654321", "line 10: the number of entities is 987654321"},
      {version4, "1 -5 2", "1 -9223372036854775808 2", "line 12: expected the number of a physical group"},
      {version4, "1 7 2 3 -4", "2 7 -5 2 3 -4", "line 14: curve 3 is in the physical groups 7 and 5"},
      {version4, "$Entities", "$PartitionedEntities", "line 9: a partitioned mesh"},
  };
  for (const Case& bad : cases) {
    const std::string fault = fault_of(replaced(bad.text, bad.from, bad.to), parse_gmsh);
    EXPECT_EQ(fault.find(bad.fault), 0u) << bad.to << ": " << fault;
  }
}

TEST(Gmsh, RefusesFilesWithoutWhatAMeshNeeds) {
  const std::string head = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                    nodes = "$Nodes\n1\n1 0 0 0\n$EndNodes\n";
  EXPECT_EQ(fault_of("", parse_gmsh), "line 1: the text ends where there should be $MeshFormat");
  EXPECT_EQ(fault_of(head, parse_gmsh), "line 4: there is no section $Nodes");
  EXPECT_EQ(fault_of(head + nodes, parse_gmsh), "line 8: there is no section $Elements");
  EXPECT_EQ(fault_of(head + nodes + "$Elements\n0\n$EndElements\n", parse_gmsh),
            "line 11: there are no triangles");
  std::string nameless = version2;
  for (const char* line : {" 5 1 1 20", " 7 2 20", " 7 3 3", " 7 4 4"}) {
    std::string without = line;
    without[1] = '0';
    nameless = replaced(nameless, line, without);
  }
  EXPECT_NE(fault_of(nameless, parse_gmsh).find("no line is in a physical group"), std::string::npos);
}

TEST(Gmsh, RefusesEveryTextThatIsCutShort) {
  for (const std::string& whole :
       {version2, replaced(version4, version4.substr(version4.find("$NodeData")), "")})
    for (std::size_t length = 0; length + 1 < whole.size(); ++length)
      EXPECT_NE(fault_of(whole.substr(0, length), parse_gmsh), "no fault") << whole.substr(0, length);
}

}  // namespace
}  // namespace signorini::api::gmsh_test
