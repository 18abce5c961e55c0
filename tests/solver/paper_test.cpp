// Section 6 of the paper: its table, and values of its problem from a boundary integral equation.
#include <gtest/gtest.h>

#include "norms.hpp"
#include "problems/membrane.hpp"

namespace signorini::paper_test {
namespace {

using problems::PaperValues;

struct Column {
  Scheme scheme;
  PaperUzawa settings;
  std::array<double, 7> paper;        ///< Table 6.1, iterations 10, 20, …, 70
  std::array<double, 7> independent;  ///< by a program that shares no code; 0 where it has two digits only
};

const Column kConforming{Scheme::conforming,
                         {0.05, 1, 1, 1e-5, 1000},
                         {0.0391011, 0.0395721, 0.0365382, 0.0315310, 0.0227896, 0.0149436, 0.0094068},
                         {0.0406, 0.0410, 0.0378, 0.0318, 0.0222, 0.0143, 0.00898}};
const Column kNonconforming{Scheme::nonconforming,
                            {0.1, 1, 0.5, 1e-5, 1000},
                            {0.0667215, 0.0354249, 0.0131121, 0.0047859, 0.0017652, 0.0006545, 0.0002429},
                            {0.0715, 0.0356, 0.0131, 0.00478, 0.00176, 0, 0}};

void expect_column(const Column& column) {
  const Solution solution = solve(problems::paper(column.scheme, 12), {column.settings, {}});
  ASSERT_GE(solution.history.size(), 70u);
  for (int i = 0; i < 7; ++i) {
    const double change = *solution.history[10 * i + 9].displacement_change;
    EXPECT_NEAR(change, column.paper[i], 0.075 * column.paper[i]) << "iteration " << 10 * i + 10;
    if (column.independent[i] > 0) {
      EXPECT_NEAR(change, column.independent[i], 0.01 * column.independent[i]) << "iteration " << 10 * i + 10;
    }
  }
}

TEST(Paper, Table61Conforming) {
  expect_column(kConforming);
}
TEST(Paper, Table61Nonconforming) {
  expect_column(kNonconforming);
}

TEST(Paper, ConformingStopsAtIteration212On8By8) {
  const Solution solution = solve(problems::paper(Scheme::conforming, 8), {kConforming.settings, {}});
  EXPECT_EQ(solution.summary.outcome, Outcome::converged);
  EXPECT_NEAR(solution.summary.iterations, 212, 2);
}

TEST(Paper, DirectionOfTheDiagonalDoesNotMatterToThreeDigits) {
  Problem problem = problems::paper(Scheme::conforming, 12);
  const Solution right = solve(problem, {kConforming.settings, {}});
  problem.mesh.pattern = Pattern::left;
  const Solution left = solve(problem, {kConforming.settings, {}});
  for (int i = 9; i < 70; i += 10)
    EXPECT_NEAR(*left.history[i].displacement_change / *right.history[i].displacement_change, 1, 2e-3);
}

/// Energies of the discrete problem by an independent program that assembles the saddle point system.
TEST(Paper, EnergiesOfAnIndependentProgram) {
  const auto energy = [](Scheme scheme, int n) {
    return solve(problems::paper(scheme, n), {ActiveSet{}, {}}).summary.energy;
  };
  EXPECT_NEAR(energy(Scheme::nonconforming, 8), -0.971589073825, 1e-11);
  EXPECT_NEAR(energy(Scheme::nonconforming, 32), -0.918444533257, 1e-11);
  EXPECT_NEAR(energy(Scheme::nonconforming, 64), -0.915712024283, 1e-11);
  EXPECT_NEAR(energy(Scheme::conforming, 8), -0.913313859492, 1e-11);
  EXPECT_NEAR(energy(Scheme::conforming, 32), -0.914796256759, 1e-11);
  EXPECT_NEAR(energy(Scheme::conforming, 64), -0.914790712778, 1e-11);
}

double at(const Solution& solution, const Point& x) {
  for (std::size_t p = 0; p < solution.mesh->points.size(); ++p)
    if ((solution.mesh->points[p] - x).norm() < 1e-12) return solution.displacement_at_points(0, p);
  ADD_FAILURE() << "no point at " << to_string(x);
  return 0;
}

void expect_exact_values(Scheme scheme, double energy_tolerance, double value_tolerance) {
  const int n = 128;
  const Solution solution = solve(problems::paper(scheme, n), {ActiveSet{}, {}});
  EXPECT_NEAR(solution.summary.energy / PaperValues::energy, 1, energy_tolerance);
  EXPECT_NEAR(solution.summary.contact.force / (2 * PaperValues::force_on_one_side), 1, value_tolerance);
  EXPECT_NEAR(at(solution, {0.25, 0.5}) / PaperValues::displacement_left, 1, value_tolerance);
  EXPECT_NEAR(at(solution, {0.75, 0.5}) / PaperValues::displacement_right, 1, value_tolerance);
  EXPECT_LT(solution.summary.residuals.tension, 1e-11);
  EXPECT_LT(solution.summary.residuals.complementarity, 1e-11);
  const double norm = displacement_error(solution, [](const Point&) { return 0; });
  EXPECT_NEAR(norm / PaperValues::displacement_norm, 1, value_tolerance);
  for (const ContactPart& part : solution.contact)
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      const double x = part.points[i].x();
      const bool near_the_end = std::abs(x - PaperValues::contact_begin) < 1.5 / n;
      if (x == 0 || near_the_end) continue;
      EXPECT_EQ(part.open[i], x < PaperValues::contact_begin) << part.name << ' ' << x;
    }
}

TEST(Paper, ExactValuesNonconforming) {
  expect_exact_values(Scheme::nonconforming, 3e-4, 5e-4);
}
TEST(Paper, ExactValuesConforming) {
  expect_exact_values(Scheme::conforming, 5e-6, 3e-4);
}

TEST(Paper, NonconformingEnergyConvergesAtRateTwo) {
  std::vector<double> errors;
  for (const int n : {16, 32, 64, 128})
    errors.push_back(
        std::abs(solve(problems::paper(Scheme::nonconforming, n), {ActiveSet{}, {}}).summary.energy -
                 PaperValues::energy));
  EXPECT_NEAR(rate(errors), 2, 0.05);
}

}  // namespace
}  // namespace signorini::paper_test
