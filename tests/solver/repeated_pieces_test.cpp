// Pieces of a dissection that are alike are eliminated once, and nothing of it is seen in the factor.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>

#include "progress/observer.hpp"
#include "system/multifrontal.hpp"
#include "system/repeated_pieces.hpp"

namespace signorini::repeated_pieces_test {
namespace {

constexpr int kKinds = 3;

/// Squares of two triangles each as elements, an unknown a side, those along the bottom last. `kind` says
/// which of a few random matrices a triangle has, -1 that it is not there. Diagonals may alternate.
ElementSum squares(int x, int y, const std::function<int(int i, int j, int triangle)>& kind, double width = 1,
                   bool alternating = false) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<> number(-1, 1);
  ElementSum sum;
  sum.per_element = 3;
  for (int k = 0; k < kKinds; ++k) {
    const Eigen::Matrix3d root = Eigen::Matrix3d::NullaryExpr([&] { return number(engine); });
    const Eigen::Matrix3d matrix = root * root.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    sum.keep(matrix.data());
  }
  std::map<std::pair<bool, std::pair<int, int>>, int> numbers;
  const auto side = [&](int twice_x, int twice_y) -> int& {
    return numbers[{twice_y == 0, {twice_y, twice_x}}];
  };
  std::vector<std::array<int*, 3>> sides;
  const auto add = [&](int i, int j, int triangle) {
    const int right = alternating && (i + j) % 2 == 1 ? 1 - triangle : triangle;
    const int of = kind(i, j, triangle), a = 2 * i + 2 * right, b = 2 * j + 2 * triangle;
    if (of < 0) return;
    sides.push_back({&side(a, 2 * j + 1), &side(2 * i + 1, b), &side(2 * i + 1, 2 * j + 1)});
    sum.matrix_of.push_back(of);
    sum.centres.emplace_back(width * (i + (1 + right) / 3.), j + (1 + triangle) / 3.);
  };
  for (int j = 0; j < y; ++j)
    for (int i = 0; i < x; ++i)
      for (int triangle = 0; triangle < 2; ++triangle) add(i, j, triangle);
  for (auto& [place, unknown] : numbers) unknown = sum.size++;
  for (const auto& own : sides)
    for (const int* unknown : own) sum.unknowns.push_back(*unknown);
  return sum;
}

/// The same with a matrix for each element: then none is known to be like another.
ElementSum apart(const ElementSum& sum) {
  ElementSum own = sum;
  own.blocks.clear();
  for (int e = 0; e < sum.elements(); ++e) own.matrix_of[e] = own.keep(sum.matrix(e));
  return own;
}

struct Made {
  explicit Made(const ElementSum& sum, int trailing)
      : order(sum, trailing, progress),
        repeated(order, sum, progress),
        factor(multifrontal(sum, trailing, progress)) {}

  int originals() const {
    int count = 0;
    order.for_each_piece([&](int piece) { count += repeated.is_original(piece); });
    return count;
  }

  Observer indifferent;
  Progress progress{indifferent, {}};
  Dissection order;
  RepeatedPieces repeated;
  Factor factor;
};

/// Answers how many pieces are originals.
int expect_the_same(const ElementSum& sum, int trailing) {
  Made shared(sum, trailing), own(apart(sum), trailing);
  EXPECT_EQ(own.originals(), own.order.pieces() - 1);
  EXPECT_EQ(shared.factor.complement(), own.factor.complement());
  const Panels &panels = shared.factor.panels(), &own_panels = own.factor.panels();
  EXPECT_EQ(panels.unknowns, own_panels.unknowns);
  for (std::size_t i = 0; i < panels.all.size(); ++i)
    for (int k = 0; k < panels.all[i].pivots; ++k) {
      const auto column = [&](const Panels& of) {
        const double* first = of.columns(of.all[i]) + static_cast<std::ptrdiff_t>(k) * of.all[i].size;
        return std::vector(first + k, first + of.all[i].size);
      };
      EXPECT_EQ(column(panels), column(own_panels));
    }
  std::mt19937 engine(2);
  std::uniform_real_distribution<> number(-1, 1);
  const Eigen::VectorXd b = Eigen::VectorXd::NullaryExpr(sum.size, [&] { return number(engine); }),
                        trailing_values =
                            Eigen::VectorXd::NullaryExpr(trailing, [&] { return number(engine); });
  Factor::Workspace workspace;
  const auto solution = [&](Made& made) {
    return made.factor.expand(made.factor.condense(b, workspace, made.progress), trailing_values, workspace,
                              made.progress);
  };
  // A column that is stored elsewhere is added up in another order.
  EXPECT_LE((solution(shared) - solution(own)).norm(), 1e-12 * solution(own).norm());
  EXPECT_LE(shared.factor.bytes(), own.factor.bytes());
  return shared.originals();
}

TEST(RepeatedPieces, OfSquaresAreNearlyAll) {
  for (const auto& [x, y] : {std::pair(64, 64), std::pair(96, 40), std::pair(61, 127)})
    for (const double width : {1., 0.3, 1e-9}) {
      const ElementSum sum = squares(
          x, y, [](int, int, int triangle) { return triangle; }, width);
      for (const int trailing : {0, x})
        EXPECT_LE(expect_the_same(sum, trailing), sum.elements() / 16) << x << y << width;
    }
}

/// Cuts between squares leave two kinds of each piece, by where its diagonals begin.
TEST(RepeatedPieces, OfAlternatingSquaresAreNearlyAll) {
  for (const auto& [x, y] : {std::pair(75, 75), std::pair(62, 127), std::pair(99, 71)})
    for (const double width : {1., 0.7, 2.}) {
      const ElementSum sum = squares(
          x, y, [](int, int, int triangle) { return triangle; }, width, true);
      EXPECT_LE(expect_the_same(sum, x), sum.elements() / 16) << x << y << width;
    }
}

TEST(RepeatedPieces, OfTwoMaterialsAreThoseWithinEach) {
  const ElementSum sum =
      squares(64, 64, [](int i, int, int triangle) { return i < 20 ? triangle : 2 * triangle; });
  EXPECT_LE(expect_the_same(sum, 64), sum.elements() / 8);
}

TEST(RepeatedPieces, ChangeNothingWhateverLiesWhere) {
  std::mt19937 engine(3);
  for (int run = 0; run < 20; ++run) {
    const int x = 4 + static_cast<int>(engine() % 30), y = 4 + static_cast<int>(engine() % 30);
    // Of one kind but for some triangles; or with holes.
    const auto others = 1 + engine() % 200, seed = engine();
    const ElementSum sum = squares(x, y, [&](int i, int j, int triangle) {
      std::mt19937 own(seed + static_cast<std::mt19937::result_type>(1000 * i + 2 * j + triangle));
      const auto drawn = own() % others;
      return drawn == 0 ? 2 : drawn == 1 && run % 2 == 1 && j > 0 ? -1 : triangle;
    });
    expect_the_same(sum, run % 3 == 0 ? 0 : x);
  }
}

}  // namespace
}  // namespace signorini::repeated_pieces_test
