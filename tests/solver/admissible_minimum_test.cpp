#include "certify/pressure/admissible_minimum.hpp"

#include <gtest/gtest.h>

#include <random>

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace signorini::admissible_minimum_test {
namespace {

/// ½ |A x|² − b·x with unknowns in different units.
struct Bowl {
  Bowl() {
    std::mt19937 engine(2);
    std::uniform_real_distribution<> number(-1, 1);
    Eigen::Matrix4d a;
    for (double& entry : a.reshaped()) entry = number(engine);
    const Eigen::Vector4d units(1, 1e3, 1e-3, 1);
    dense =
        units.asDiagonal() * (a.transpose() * a + Eigen::Matrix4d::Identity()).eval() * units.asDiagonal();
    slope = -units.cwiseProduct(Eigen::Vector4d(1, -2, 3, 1));
    curvature = dense.sparseView();
  }

  Eigen::VectorXd minimum(const std::vector<MovingPressure>& moving,
                          const std::vector<LinearForm>& conditions = {}) {
    return admissible_minimum(Eigen::SparseMatrix<double>(curvature), slope, moving, conditions, progress);
  }
  /// With x_k given.
  Eigen::Vector4d minimum_with(int k, double x) const {
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(5, 5);
    system.topLeftCorner<4, 4>() = dense;
    system(4, k) = system(k, 4) = 1;
    Eigen::VectorXd right(5);
    right << -slope, x;
    return system.fullPivHouseholderQr().solve(right).head<4>();
  }

  Eigen::Matrix4d dense;
  Eigen::Vector4d slope;
  Eigen::SparseMatrix<double> curvature;
  Observer observer;
  Progress progress{observer, std::nullopt};
};

TEST(AdmissibleMinimum, IsTheMinimumWhereNoPressureStopsIt) {
  Bowl bowl;
  const Eigen::Vector4d lowest = -bowl.dense.ldlt().solve(bowl.slope);
  EXPECT_LE((bowl.minimum({}) - lowest).norm(), 1e-8 * lowest.norm());
  const MovingPressure far{0, 0, 10 * std::abs(lowest[1]), {{1, 1.}}, 0, false};
  EXPECT_LE((bowl.minimum({far}) - lowest).norm(), 1e-8 * lowest.norm());
}

TEST(AdmissibleMinimum, KeepsAPressureThatVanishesAndGoesOn) {
  Bowl bowl;
  const Eigen::Vector4d lowest = -bowl.dense.ldlt().solve(bowl.slope);
  for (int k = 0; k < 4; ++k) {
    // It would vanish on half the way.
    const double sign = lowest[k] < 0 ? 1 : -1, start = std::abs(lowest[k]) / 2;
    const MovingPressure near{0, 0, start, {{k, sign}}, 0, false};
    const Eigen::Vector4d expected = bowl.minimum_with(k, lowest[k] / 2), found = bowl.minimum({near});
    EXPECT_NEAR(start + sign * found[k], 0, 1e-8 * start);
    EXPECT_LE((found - expected).cwiseQuotient(lowest).norm(), 1e-8);
  }
}

TEST(AdmissibleMinimum, MeetsConditionsLeavesWhatIsKeptAndPaysForRoom) {
  Bowl bowl;
  const MovingPressure kept{0, 0, 1, {{2, 5.}}, 0, true};
  const Eigen::Vector4d found = bowl.minimum({kept});
  EXPECT_LE((found - bowl.minimum_with(2, 0)).cwiseQuotient(found + Eigen::Vector4d::Unit(2)).norm(), 1e-8);
  EXPECT_LE((found - bowl.minimum({}, {{{2, 1.}}})).norm(), 1e-8 * found.norm());
  const MovingPressure costly{0, 0, 1e9, {{0, 2.}}, 0.25, false};
  Bowl steeper;
  steeper.slope[0] += 2 * 0.25;
  EXPECT_LE((bowl.minimum({costly}) - steeper.minimum({})).norm(), 1e-8 * found.norm());
}

}  // namespace
}  // namespace signorini::admissible_minimum_test
