#include "fem/stress_invariants.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

namespace signorini::stress_invariants_test {
namespace {

/// Random stresses (σ_xx, σ_yy, σ_xy, σ_zz) as tensors: their invariants from the eigenvalues.
TEST(StressInvariants, AgreeWithTheEigenvaluesOfTheTensor) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d stress(normal(random), normal(random), normal(random));
    const double out_of_plane = normal(random);
    Eigen::Matrix2d plane;
    plane << stress[0], stress[2], stress[2], stress[1];
    const Eigen::Vector2d ascending = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(plane).eigenvalues();
    const auto [first, second] = principal_stresses(stress);
    EXPECT_NEAR(first, ascending[1], 1e-14);
    EXPECT_NEAR(second, ascending[0], 1e-14);

    // √(3/2) times the norm of the deviator.
    const double pressure = (ascending.sum() + out_of_plane) / 3;
    const Eigen::Vector3d deviator =
        Eigen::Vector3d(ascending[0], ascending[1], out_of_plane).array() - pressure;
    EXPECT_NEAR(von_mises(stress, out_of_plane), std::sqrt(1.5) * deviator.norm(), 1e-14);
  }
}

TEST(StressInvariants, HaveTheirTextbookValues) {
  EXPECT_DOUBLE_EQ(von_mises({3, 0, 0}, 0), 3);                 // a bar
  EXPECT_DOUBLE_EQ(von_mises({0, 0, 2}, 0), 2 * std::sqrt(3));  // shear
  EXPECT_EQ(von_mises({-5, -5, 0}, -5), 0);                     // pressure from all sides
  EXPECT_EQ(principal_stresses({0, 0, -2}), (std::array<double, 2>{2, -2}));
}

TEST(StressInvariants, StayWithinTheRangeOfNumbers) {
  for (const double unit : {1e-300, 1e300}) {
    EXPECT_NEAR(von_mises({3 * unit, 0, 0}, 0) / unit, 3, 1e-14);
    EXPECT_NEAR(principal_stresses({3 * unit, 0, 2 * unit})[0] / unit, 4, 1e-14);
  }
}

}  // namespace
}  // namespace signorini::stress_invariants_test
