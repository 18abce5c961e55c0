// Projections of functions that take many cells.

#include "fem/projection.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "fem/triangle_pieces.hpp"
#include "problems/membrane.hpp"

namespace signorini::projection_test {
namespace {

const std::array<Point, 3> kReference{Point(0, 0), Point(1, 0), Point(0, 1)};

Projection projection_of(const std::string& formula) {
  CellBudget budget{1'000'000};
  return project(problems::formula(formula), kReference, {1e-9, 5e-7}, budget);
}

/// ∫ sin(k x)² over the reference triangle.
double square_of_wave(double k) {
  return 0.25 - (1 - std::cos(2 * k)) / (8 * k * k);
}

/// By Pythagoras ‖f‖² = ‖Π₂f‖² + ‖f − Π₂f‖², also where there are more points than are kept.
TEST(Projection, OfAWaveLeavesTheRestOfItsNorm) {
  for (const int k : {5, 50, 400}) {
    const Projection wave = projection_of("sin(" + std::to_string(k) + " * x)");
    const double rest = std::sqrt(square_of_wave(k) - std::pow(norm(wave.quadratic), 2));
    EXPECT_GE(wave.rest, rest * (1 - 1e-9)) << k;
    // With what the integrals are off by: where it takes many cells they are known less well.
    EXPECT_LE(wave.rest, rest * (k < 10 ? 1.001 : 1.05)) << k;
  }
}

TEST(Projection, OfASmallWaveOnALargeValueLosesNothing) {
  const Projection wave = projection_of("sin(400 * x)"), high = projection_of("1000 + sin(400 * x)");
  EXPECT_NEAR(high.rest, wave.rest, 1e-3 * wave.rest);
  EXPECT_GE(high.rest, wave.rest * (1 - 1e-9));
  EXPECT_NEAR(high.quadratic[0], 1000 + wave.quadratic[0], 1e-9);
}

}  // namespace
}  // namespace signorini::projection_test
