#include "contact/cone.hpp"

#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

constexpr double kConeRounding = 1e-10;

}  // namespace

/// Lawson, Hanson 1974, non-negative least squares: the distance to the cone falls strictly with every
/// generator that joins the basis, and a basis has no more of them than dimensions.
Eigen::VectorXd beyond_cone(const std::vector<Eigen::VectorXd>& generators, const Eigen::VectorXd& target) {
  std::vector<int> basis;
  Eigen::VectorXd weights, residual = target;
  const auto fit = [&] {
    Eigen::MatrixXd columns(target.size(), basis.size());
    for (std::size_t k = 0; k < basis.size(); ++k) columns.col(k) = generators[basis[k]];
    const Eigen::VectorXd fitted = least_squares(columns, target);
    residual = target - columns * fitted;
    return fitted;
  };
  for (std::size_t step = 0; step <= 3 * generators.size() + 10; ++step) {
    if (residual.norm() <= kConeRounding * target.norm()) return Eigen::VectorXd::Zero(target.size());
    int best = -1;
    double steepest = kConeRounding * target.norm();
    for (int i = 0; i < static_cast<int>(generators.size()); ++i) {
      const double size = generators[i].norm();
      const double slope = size > 0 ? generators[i].dot(residual) / size : 0;
      if (slope > steepest) best = i, steepest = slope;
    }
    if (best < 0) return residual;
    basis.push_back(best);
    weights.conservativeResize(basis.size());
    weights[weights.size() - 1] = 0;
    for (Eigen::VectorXd fitted = fit();; fitted = fit()) {
      if (fitted.minCoeff() > 0) {
        weights = fitted;
        break;
      }
      // Go towards the fit until a weight meets 0, and let that generator go.
      double way = 1;
      for (Eigen::Index k = 0; k < fitted.size(); ++k)
        if (fitted[k] <= 0) way = std::min(way, weights[k] / (weights[k] - fitted[k]));
      weights += way * (fitted - weights);
      Eigen::Index leaving;
      weights.minCoeff(&leaving);
      basis.erase(basis.begin() + leaving);
      std::vector<double> kept;
      for (Eigen::Index k = 0; k < weights.size(); ++k)
        if (k != leaving) kept.push_back(weights[k]);
      weights = Eigen::Map<Eigen::VectorXd>(kept.data(), static_cast<Eigen::Index>(kept.size()));
      if (basis.empty()) return target;
    }
  }
  return residual;
}

}  // namespace signorini
