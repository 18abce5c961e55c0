// Pieces of a mesh share few unknowns, whatever its shape.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "progress/observer.hpp"
#include "system/dissection.hpp"
#include "system/element_tree.hpp"

namespace signorini::dissection_test {
namespace {

/// Squares of two triangles each as elements, an unknown a side; the squares are `width` by 1. Of the rows of
/// an element those beyond three are left out.
ElementSum squares(int x, int y, const std::function<bool(int, int)>& is_there, double width = 1,
                   int rows = 3) {
  ElementSum sum;
  sum.per_element = rows;
  std::map<std::pair<int, int>, int> numbers;
  const auto side = [&](int twice_x, int twice_y) {
    return numbers.try_emplace({twice_x, twice_y}, static_cast<int>(numbers.size())).first->second;
  };
  const auto add = [&](int a, int b, int c, double at_x, double at_y) {
    sum.unknowns.insert(sum.unknowns.end(), {a, b, c});
    sum.unknowns.insert(sum.unknowns.end(), rows - 3, -1);
    sum.matrix_of.push_back(0);
    sum.centres.emplace_back(width * at_x, at_y);
  };
  for (int j = 0; j < y; ++j)
    for (int i = 0; i < x; ++i) {
      if (!is_there(i, j)) continue;
      const int a = 2 * i, b = 2 * j, diagonal = side(a + 1, b + 1);
      add(side(a, b + 1), side(a + 1, b), diagonal, i + 1 / 3., j + 1 / 3.);
      add(side(a + 2, b + 1), side(a + 1, b + 2), diagonal, i + 2 / 3., j + 2 / 3.);
    }
  sum.size = static_cast<int>(numbers.size());
  return sum;
}

bool everywhere(int, int) {
  return true;
}

/// The unknowns that the first cut parts, and the numbers in all fronts.
struct Cost {
  int first_cut;
  double panels;
};

Cost cost_of(const ElementSum& sum) {
  Observer indifferent;
  Progress progress(indifferent, {});
  const Dissection dissection(sum, 0, progress);
  Cost cost{dissection.front(1).pivots, 0};
  std::vector<int> found;
  dissection.for_each_piece([&](int piece) {
    const Dissection::Front front = dissection.front(piece);
    cost.panels += static_cast<double>(front.pivots) * front.size();
    if (!dissection.is_leaf(piece)) return;
    const auto elements = dissection.elements(piece);
    EXPECT_GE(elements.size(), 4);
    EXPECT_LE(elements.size(), 32);
    found.insert(found.end(), elements.begin(), elements.end());
  });
  std::ranges::sort(found);
  for (int e = 0; e < sum.elements(); ++e) EXPECT_EQ(found.at(e), e);
  return cost;
}

TEST(Dissection, CutsASquareAtItsMiddle) {
  EXPECT_EQ(cost_of(squares(64, 64, everywhere)).first_cut, 64);
}

/// At the median a cut goes through the squares of the middle row.
TEST(Dissection, CutsBetweenRows) {
  EXPECT_EQ(cost_of(squares(41, 41, everywhere)).first_cut, 41);
  EXPECT_EQ(cost_of(squares(9, 333, everywhere)).first_cut, 9);
}

TEST(Dissection, CutsAcrossArmsAndNotAlongThem) {
  const auto nine_teeth = [](int i, int j) { return j < 2 || i % 8 < 4; };
  EXPECT_EQ(cost_of(squares(68, 66, nine_teeth)).first_cut, 2);
  const auto angle = [](int i, int j) { return i < 10 || j < 10; };
  for (const int rows : {3, 9}) EXPECT_EQ(cost_of(squares(100, 100, angle, 1, rows)).first_cut, 10);
}

/// What is like it is cut as its neighbour was, of which one is looked at.
TEST(ElementTree, CutsHalvesThatAreAlikeInTheSameWay) {
  Observer indifferent;
  Progress progress(indifferent, {});
  const ElementSum sum = squares(64, 32, everywhere);
  const ElementTree tree(sum.centres, {sum.unknowns, sum.per_element, sum.size}, progress);
  for (int leaf = 0; leaf < tree.leaves() / 2; ++leaf) {
    const auto first = tree.elements(tree.leaves() + leaf),
               second = tree.elements(tree.leaves() + tree.leaves() / 2 + leaf);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_NEAR((sum.centres[second[i]] - sum.centres[first[i]] - Point(32, 0)).norm(), 0, 1e-12);
  }
}

/// The order depends on which squares touch, not on how long they are.
TEST(Dissection, CutsWhereFewSidesAre) {
  for (const double width : {1e-3, 1e3}) {
    const Cost cost = cost_of(squares(64, 64, everywhere, width));
    EXPECT_EQ(cost.first_cut, 64);
    EXPECT_LE(cost.panels, 1.7 * cost_of(squares(64, 64, everywhere)).panels);
  }
  EXPECT_LE(cost_of(squares(400, 8, everywhere, 1e-3)).first_cut, 8);
}

}  // namespace
}  // namespace signorini::dissection_test
