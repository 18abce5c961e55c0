// The sparse factorisations against dense algebra.
#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <numeric>
#include <random>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "system/cholmod.hpp"
#include "system/dense_cholesky.hpp"
#include "system/lower_triangle.hpp"
#include "system/multifrontal.hpp"
#include "system/symmetric_product.hpp"

namespace signorini::factor_test {
namespace {

/// A symmetric matrix whose unknowns lie at points, as a sum of elements.
struct PlacedMatrix {
  Eigen::MatrixXd k;
  std::vector<Point> points;

  int size() const { return static_cast<int>(k.rows()); }
  int leading(int trailing) const { return size() - trailing; }

  /// Elements of two rows: one for each pair i, j, and for the diagonal one that has i twice.
  ElementSum sum() const {
    ElementSum sum;
    sum.size = size();
    sum.per_element = 2;
    for (int j = 0; j < size(); ++j)
      for (int i = j; i < size(); ++i)
        if (i == j)
          add(sum, i, j, {k(i, i) / 8, k(i, i) / 4, k(i, i) / 4, 3 * k(i, i) / 8});
        else if (k(i, j) != 0)
          add(sum, i, j, {0, k(i, j), k(i, j), 0});
    return sum;
  }

 private:
  void add(ElementSum& sum, int i, int j, const std::array<double, 4>& matrix) const {
    sum.unknowns.insert(sum.unknowns.end(), {i, j});
    sum.matrix_of.push_back(sum.keep(matrix.data()));
    sum.centres.emplace_back((points[i] + points[j]) / 2);
  }
};

/// A random sparse SPD matrix: a grid Laplacian plus random diagonal, its unknowns shuffled.
PlacedMatrix random_matrix(int side, unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<> number(0.1, 1);
  const int n = side * side;
  std::vector<int> place(n);
  for (int i = 0; i < n; ++i) place[i] = i;
  std::shuffle(place.begin(), place.end(), engine);
  PlacedMatrix matrix{Eigen::MatrixXd::Zero(n, n), std::vector<Point>(n)};
  Eigen::MatrixXd& k = matrix.k;
  const auto connect = [&](int i, int j) {
    const double weight = number(engine);
    k(i, i) += weight, k(j, j) += weight, k(i, j) -= weight, k(j, i) -= weight;
  };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int i = place[y * side + x];
      matrix.points[i] = Point(x, y);
      if (x + 1 < side) connect(i, place[y * side + x + 1]);
      if (y + 1 < side) connect(i, place[(y + 1) * side + x]);
      k(i, i) += 0.01 * number(engine);
    }
  return matrix;
}

/// A random dense SPD matrix of unknowns on a line.
PlacedMatrix dense_matrix(int n) {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n);
  PlacedMatrix matrix{Eigen::MatrixXd(a * a.transpose() / n) + Eigen::MatrixXd::Identity(n, n), {}};
  for (int i = 0; i < n; ++i) matrix.points.emplace_back(i, 0);
  return matrix;
}

/// Two matrices that do not touch, the last few unknowns of each at the end.
PlacedMatrix side_by_side(const PlacedMatrix& a, const PlacedMatrix& b, int last_of_each) {
  const int n = a.size(), m = b.size();
  std::vector<int> order;
  for (int i = 0; i < n - last_of_each; ++i) order.push_back(i);
  for (int i = 0; i < m - last_of_each; ++i) order.push_back(n + i);
  for (int i = n - last_of_each; i < n; ++i) order.push_back(i);
  for (int i = m - last_of_each; i < m; ++i) order.push_back(n + i);
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(n + m, n + m);
  both.topLeftCorner(n, n) = a.k;
  both.bottomRightCorner(m, m) = b.k;
  PlacedMatrix all{Eigen::MatrixXd(n + m, n + m), {}};
  for (int i = 0; i < n + m; ++i) {
    all.points.push_back(order[i] < n ? a.points[order[i]] : b.points[order[i] - n]);
    for (int j = 0; j < n + m; ++j) all.k(i, j) = both(order[i], order[j]);
  }
  return all;
}

/// One of the ways to a factor.
struct Way {
  const char* name;
  std::function<Factor(const ElementSum&, int trailing, Progress&)> factor;

  friend void PrintTo(const Way& printed, std::ostream* out) { *out << printed.name; }
};

Way by_cholmod(const char* name, CholmodOrder order) {
  return {name, [order](const ElementSum& sum, int trailing, Progress& progress) {
            return cholmod(sum, trailing, progress, order);
          }};
}

class SparseFactor : public testing::TestWithParam<Way> {
 protected:
  static Factor factor_of(const PlacedMatrix& matrix, int trailing) {
    Observer indifferent;
    Progress progress(indifferent, {});
    return GetParam().factor(matrix.sum(), trailing, progress);
  }
  static void expect_dense_answers(const PlacedMatrix& matrix, int trailing);
};

INSTANTIATE_TEST_SUITE_P(Ways, SparseFactor,
                         testing::Values(Way{"Multifrontal", multifrontal},
                                         by_cholmod("CholmodInGivenOrder", CholmodOrder::given),
                                         by_cholmod("CholmodInOwnOrder", CholmodOrder::own)),
                         [](const auto& way) { return way.param.name; });

void SparseFactor::expect_dense_answers(const PlacedMatrix& matrix, int trailing) {
  const Eigen::MatrixXd& k = matrix.k;
  const int leading = matrix.leading(trailing);
  const Factor factor = factor_of(matrix, trailing);
  const auto inner = k.topLeftCorner(leading, leading).ldlt();
  const Eigen::MatrixXd coupling = k.topRightCorner(leading, trailing);
  const Eigen::MatrixXd complement =
      k.bottomRightCorner(trailing, trailing) - coupling.transpose() * inner.solve(coupling);
  EXPECT_LT((factor.complement() - complement).norm(), 1e-10);

  const Eigen::VectorXd b = Eigen::VectorXd::Random(k.rows());
  Factor::Workspace workspace;
  Observer indifferent;
  Progress progress(indifferent, {});
  const Factor::Condensed condensed = factor.condense(b, workspace, progress);
  const Eigen::VectorXd right = b.tail(trailing) - coupling.transpose() * inner.solve(b.head(leading));
  EXPECT_LT((condensed.trailing - right).norm(), 1e-10);

  const Eigen::VectorXd given = Eigen::VectorXd::Random(trailing);
  const Eigen::VectorXd expanded = factor.expand(condensed, given, workspace, progress);
  EXPECT_EQ(expanded.tail(trailing), given);
  EXPECT_LT((expanded.head(leading) - inner.solve(b.head(leading) - coupling * given)).norm(), 1e-10);
}

TEST_P(SparseFactor, ComplementAndSolvesAgreeWithDenseAlgebra) {
  for (const int trailing : {0, 1, 7, 40}) expect_dense_answers(random_matrix(16, 3 + trailing), trailing);
}

TEST_P(SparseFactor, FactorsFrontsOfManyColumns) {
  for (const int trailing : {0, 40}) expect_dense_answers(dense_matrix(600), trailing);
}

TEST_P(SparseFactor, SplitsIntoPiecesWhereTheMatrixDoes) {
  expect_dense_answers(side_by_side(random_matrix(5, 1), random_matrix(7, 2), 3), 6);
}

TEST_P(SparseFactor, SolvesInPlace) {
  const PlacedMatrix matrix = random_matrix(16, 4);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.size());
  Eigen::VectorXd x = b;
  Factor::Workspace workspace;
  Observer indifferent;
  Progress progress(indifferent, {});
  factor_of(matrix, 0).solve(x, workspace, progress);
  EXPECT_LT((matrix.k * x - b).norm(), 1e-11);
}

TEST_P(SparseFactor, TellsWhatIsNotPositiveDefinite) {
  PlacedMatrix negative = random_matrix(6, 1);
  negative.k(17, 17) = -1;
  EXPECT_THROW(factor_of(negative, 4), NotPositiveDefinite);
  PlacedMatrix large_and_negative = dense_matrix(300);
  large_and_negative.k(280, 280) = -1;
  EXPECT_THROW(factor_of(large_and_negative, 4), NotPositiveDefinite);
  PlacedMatrix indefinite = random_matrix(6, 1);
  indefinite.k(17, 18) = indefinite.k(18, 17) = 100;
  EXPECT_THROW(factor_of(indefinite, 4), NotPositiveDefinite);
  PlacedMatrix almost_singular = random_matrix(6, 1);
  // Two unknowns so stiffly tied that eliminating the one leaves 1e-15 of the entry of the other.
  almost_singular.k({17, 18}, {17, 18}) += 1e15 * Eigen::Matrix2d{{1, -1}, {-1, 1}};
  EXPECT_THROW(factor_of(almost_singular, 4), NotPositiveDefinite);
  PlacedMatrix not_a_number = random_matrix(6, 1);
  not_a_number.k(17, 17) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(factor_of(not_a_number, 4), NotPositiveDefinite);
  ElementSum with_empty_row = random_matrix(6, 1).sum();
  ++with_empty_row.size;
  Observer indifferent;
  Progress progress(indifferent, {});
  EXPECT_THROW(GetParam().factor(with_empty_row, 0, progress), NotPositiveDefinite);
  EXPECT_THROW(GetParam().factor(with_empty_row, 1, progress), NotPositiveDefinite);
}

/// As where contact alone holds a body: K 1 = 0, and so is S 1.
TEST_P(SparseFactor, LeavesASingularComplement) {
  constexpr int trailing = 12;
  PlacedMatrix singular = random_matrix(16, 7);
  singular.k.diagonal().array() -= singular.k.rowwise().sum().array();
  const Eigen::MatrixXd s = factor_of(singular, trailing).complement();
  const double size = singular.k.diagonal().maxCoeff();
  EXPECT_LT(s.rowwise().sum().cwiseAbs().maxCoeff(), 1e-13 * size);
  EXPECT_GT(s.diagonal().minCoeff(), 1e-3 * size);
  expect_dense_answers(singular, trailing);
}

TEST_P(SparseFactor, EndsWhenTheObserverDoes) {
  struct Impatient : Observer {
    int left = 5;
    bool keep_going() override { return --left > 0; }
  } impatient;
  Progress progress(impatient, {});
  EXPECT_THROW(GetParam().factor(random_matrix(16, 1).sum(), 4, progress), Cancelled);
}

TEST_P(SparseFactor, ALongSolveEndsWhenTheObserverDoes) {
  constexpr int n = 800;
  PlacedMatrix matrix{Eigen::MatrixXd::Ones(n, n) + Eigen::MatrixXd::Identity(n, n), {}};
  for (int i = 0; i < n; ++i) matrix.points.emplace_back(i, 0);
  const Factor factor = factor_of(matrix, 0);
  struct Unwilling : Observer {
    bool keep_going() override { return false; }
  } unwilling;
  Progress progress(unwilling, {});
  Factor::Workspace workspace;
  Eigen::VectorXd x = Eigen::VectorXd::Ones(n);
  EXPECT_THROW(factor.solve(x, workspace, progress), Cancelled);
}

TEST(DenseCholesky, SolvesWithSomeRowsOfAMatrix) {
  for (const int n : {1, 7, 300}) {
    const Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd s = a * a.transpose() + n * Eigen::MatrixXd::Identity(n, n);
    std::vector<int> chosen;
    for (int i = n - 1; i >= 0; i -= 2) chosen.push_back(i);
    const Eigen::VectorXd b = Eigen::VectorXd::Random(static_cast<Eigen::Index>(chosen.size()));
    Observer indifferent;
    Progress progress(indifferent, {});
    const Eigen::VectorXd x = DenseCholesky(s, chosen, progress).solve(b, progress);
    EXPECT_LT((s(chosen, chosen) * x - b).norm(), 1e-12 * b.norm()) << n;
    const Eigen::VectorXd all = Eigen::VectorXd::Random(n);
    EXPECT_LT((symmetric_product(s, all, progress) - s * all).norm(), 1e-13 * (s * all).norm()) << n;
  }
}

TEST(DenseCholesky, LongWorkEndsWhenTheObserverDoes) {
  constexpr int n = 900;
  const Eigen::MatrixXd s = Eigen::MatrixXd::Ones(n, n) + Eigen::MatrixXd::Identity(n, n);
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(n);
  std::vector<int> all(n);
  std::iota(all.begin(), all.end(), 0);
  Observer indifferent;
  Progress goes_on(indifferent, {});
  const DenseCholesky factor(s, all, goes_on);
  struct Unwilling : Observer {
    bool keep_going() override { return false; }
  } unwilling;
  Progress ends(unwilling, {});
  EXPECT_THROW(DenseCholesky(s, all, ends), Cancelled);
  EXPECT_THROW(factor.solve(x, ends), Cancelled);
  EXPECT_THROW(symmetric_product(s, x, ends), Cancelled);
}

TEST(LowerTriangle, HasAPlaceForEachNumberAndHardlyMore) {
  for (int rows = 0; rows < 400; rows += rows < 20 ? 1 : 37) {
    SCOPED_TRACE(rows);
    const LowerTriangle lower(rows);
    std::vector<int> taken(lower.size(), 0);
    for (int j = 0; j < rows; ++j)
      for (int i = j; i < rows; ++i) ++taken.at(lower.column(taken.data(), j) + i - taken.data());
    EXPECT_EQ(std::ranges::count(taken, 1), rows * (rows + 1) / 2);
    EXPECT_EQ(std::ranges::count_if(taken, [](int times) { return times > 1; }), 0);
    EXPECT_GE(numbers_of_lower_triangle(rows), static_cast<double>(lower.size()));
    EXPECT_LE(lower.size(), static_cast<std::size_t>(rows) * (rows + LowerTriangle::kStrip) / 2 +
                                LowerTriangle::kStrip * LowerTriangle::kStrip);
  }
}

}  // namespace
}  // namespace signorini::factor_test
