// The last step of the certificate: from sums over the mesh to the bound, against the formula of THEORY.md,
// Theorem 2.

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "certify/totals.hpp"

namespace signorini::bound_from_test {
namespace {

/// Without a second pair, and with nothing that is not known.
Totals random_totals(std::mt19937& random) {
  std::uniform_real_distribution<double> square(0.1, 2);
  Totals totals(1);
  totals.second_counts = false;
  totals.contact = square(random);
  totals.all.gap = totals.balanced_gap = square(random);
  totals.all.correction = totals.balanced_correction = square(random);
  totals.all.direct_gap = square(random);
  totals.all.skew = square(random);
  totals.all.stress = square(random);
  totals.all.strain = square(random);
  totals.all.energy = square(random);
  return totals;
}

/// The same with a second pair that is the better way: it takes the correction away, and most is known of it.
Totals with_second_pair(Totals totals) {
  totals.second_counts = true;
  totals.all.span = totals.all.along = totals.all.correction;
  totals.all.known = 0.01;
  totals.all.moved = totals.all.correction;
  return totals;
}

TEST(BoundFrom, IsTheFormulaOfTheTheorem) {
  std::mt19937 random(1);
  for (int run = 0; run < 100; ++run) {
    const Totals totals = random_totals(random);
    const ErrorBound bound = bound_from(totals);
    const double g = std::sqrt(totals.balanced_gap), d = std::sqrt(totals.balanced_correction),
                 c = totals.contact;
    const double square =
        c + (g * g + d * d + totals.all.direct_gap) / 2 + d * std::sqrt(g * g + 2 * c) + totals.all.skew;
    EXPECT_NEAR(bound.value, std::sqrt(square), 1e-12 * bound.value);
    EXPECT_NEAR(bound.relative, std::sqrt(square / totals.all.stress), 1e-12 * bound.relative);
    EXPECT_NEAR(bound.energy_upper, totals.all.energy, 1e-11);
    EXPECT_NEAR(bound.energy_lower, totals.all.energy - (g * g + c) / 2, 1e-11);
  }
}

TEST(BoundFrom, GrowsWithAllThatIsNotKnown) {
  const std::vector<std::function<void(Totals&)>> more{
      [](Totals& totals) { totals.all.slack += 0.1; },
      [](Totals& totals) { totals.carried += 0.1; },
  };
  std::mt19937 random(2);
  for (int run = 0; run < 100; ++run) {
    const Totals direct = random_totals(random);
    for (const Totals& totals : {direct, with_second_pair(direct)})
      for (const auto& add : more) {
        Totals larger = totals;
        add(larger);
        EXPECT_GT(bound_from(larger).value, bound_from(totals).value);
        EXPECT_LT(bound_from(larger).energy_lower, bound_from(totals).energy_lower);
      }
  }
}

/// Carried loads and slack count in the gap and in the correction, each by itself.
TEST(BoundFrom, CountsTheUnknownInEachPart) {
  Totals totals(1);
  totals.second_counts = false;
  totals.carried = 1;
  EXPECT_NEAR(bound_from(totals).value, std::sqrt(2), 1e-12);  // (1 + 1) / 2 + 1 · 1
  totals.carried = 0;
  totals.all.slack = 1;
  EXPECT_NEAR(bound_from(totals).value, std::sqrt(3.5),
              1e-12);  // the same, ½ for the direct gap, 1 for the skew part
}

TEST(BoundFrom, KnowsLessOfTheSecondPairWhereLoadsAreUncertain) {
  std::mt19937 random(3);
  for (int run = 0; run < 100; ++run) {
    const Totals totals = with_second_pair(random_totals(random));
    EXPECT_LT(bound_from(totals).value, bound_from([&] {
                                          Totals direct = totals;
                                          direct.second_counts = false;
                                          return direct;
                                        }())
                                            .value);
    Totals oscillating = totals;
    oscillating.oscillation_square = 1e-4;
    EXPECT_GT(bound_from(oscillating).value, bound_from(totals).value);
    Totals still = totals, moved = totals;
    still.carried = moved.carried = 1e-3;
    still.all.moved = 0;
    moved.all.moved = 1;
    EXPECT_GT(bound_from(moved).value, bound_from(still).value);
  }
}

/// min(D R, M) with M of Theorem 3, to which what makes up for oscillation and carried loads adds its norm.
TEST(BoundFrom, IsTheFormulaOfTheTheoremWithASecondPair) {
  std::mt19937 random(4);
  for (int run = 0; run < 100; ++run) {
    Totals totals = with_second_pair(random_totals(random));
    totals.oscillation_square = 1e-6;
    totals.carried = 1e-3;
    totals.all.slack = 1e-4;
    const TriangleSums& all = totals.all;
    const double g = std::sqrt(totals.balanced_gap + all.slack) + totals.carried,
                 d = std::sqrt(totals.balanced_correction + all.slack) + totals.carried, c = totals.contact,
                 r = std::sqrt(g * g + 2 * c),
                 k = all.known + totals.carried *
                                     (2 * std::sqrt(all.moved + all.slack) + std::sqrt(all.span + all.slack)),
                 m = least_over_the_way(all.correction, all.span, all.along, r, k, all.slack) +
                     (std::sqrt(totals.oscillation_square) + totals.carried) * r;
    ASSERT_LT(m, d * r);
    const double square = c + (g * g + d * d + all.direct_gap + all.slack) / 2 + m + all.skew + all.slack;
    EXPECT_NEAR(bound_from(totals).value, std::sqrt(square), 1e-12 * std::sqrt(square));
  }
}

TEST(BoundFrom, LeavesRoomForRoundingInTheEnergies) {
  Totals totals(1);
  totals.all.energy = 1;
  EXPECT_LT(bound_from(totals).energy_lower, 1);
  EXPECT_GT(bound_from(totals).energy_upper, 1);
  totals.all.energy_slack = 0.5;
  EXPECT_LE(bound_from(totals).energy_lower, 0.5);
  EXPECT_GE(bound_from(totals).energy_upper, 1.5);
}

}  // namespace
}  // namespace signorini::bound_from_test
