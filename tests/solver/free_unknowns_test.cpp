#include "certify/pressure/free_unknowns.hpp"

#include <gtest/gtest.h>

#include <random>

#include <Eigen/QR>

namespace signorini::free_unknowns_test {
namespace {

/// A chain of rows, each with unknowns of its neighbours, some of them twice or the sum of two others.
TEST(FreeUnknowns, SpanWhatAllRowsHaveInCommon) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<> number(-1, 1);
  constexpr int unknowns = 12;
  std::vector<LinearForm> rows;
  for (int i = 0; i + 4 < unknowns; ++i) {
    LinearForm row;
    for (int k = 0; k < 4; ++k) row.emplace_back(i + k, 1e6 * number(engine));
    rows.push_back(row);
  }
  rows.push_back(rows[2]);
  LinearForm sum = rows[0];
  sum.insert(sum.end(), rows[1].begin(), rows[1].end());
  rows.push_back(sum);
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(rows.size(), unknowns);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (const auto& [unknown, factor] : rows[i]) dense(i, unknown) += factor;
  FreeUnknowns free;
  for (const LinearForm& row : rows) free.take_away(row);
  const Eigen::MatrixXd basis = free.basis(unknowns);
  EXPECT_EQ(basis.cols(), 4);
  EXPECT_LE((dense * basis).norm(), 1e-8 * basis.norm());
  EXPECT_EQ(basis.colPivHouseholderQr().rank(), 4);
}

}  // namespace
}  // namespace signorini::free_unknowns_test
