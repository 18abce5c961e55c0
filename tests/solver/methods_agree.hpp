#pragma once

#include <gtest/gtest.h>

#include "solve.hpp"

namespace signorini {

/// Expects the active set and the accelerated Uzawa iteration to find the same fields, the active set within
/// twelve dense steps from nothing and with residuals at rounding. Returns what the active set found.
inline Solution expect_methods_agree(const Problem& problem) {
  const Solution exact = solve(problem, {ActiveSet{}, {}});
  const Solution uzawa = solve(problem, {Mprgp{1e-12, 100000}, {}});
  EXPECT_EQ(exact.summary.outcome, Outcome::converged);
  EXPECT_EQ(uzawa.summary.outcome, Outcome::converged);
  EXPECT_LE(exact.summary.iterations, 12);
  const auto difference = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
  };
  EXPECT_LT(difference(uzawa.stress, exact.stress), 1e-8);
  EXPECT_LT(difference(uzawa.displacement, exact.displacement), 1e-8);
  EXPECT_LT(difference(uzawa.rotation, exact.rotation), 1e-8);
  const Residuals& residuals = exact.summary.residuals;
  for (const double residual : {residuals.equilibrium, residuals.constitutive, residuals.penetration,
                                residuals.tension, residuals.complementarity, residuals.symmetry})
    EXPECT_LT(residual, 1e-11);
  return exact;
}

}  // namespace signorini
