#include "fem/small_matrices.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace signorini {
namespace {

using Solver = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;

}  // namespace

Spectrum::Spectrum(const Eigen::MatrixXd& symmetric) {
  const Solver solver(symmetric);
  values = solver.eigenvalues();
  vectors = solver.eigenvectors();
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& symmetric) {
  return Solver(symmetric, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const Eigen::LDLT<Eigen::MatrixXd> factor(a);
  Eigen::MatrixXd all(b.rows(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) all.col(j) = factor.solve(b.col(j));
  return all;
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

Eigen::MatrixXd shortest_least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b,
                                       std::optional<double> smallest_pivot) {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  if (smallest_pivot) decomposition.setThreshold(*smallest_pivot);
  return decomposition.compute(a).solve(b);
}

Eigen::MatrixXd kernel(const Eigen::MatrixXd& a, std::optional<double> smallest_pivot) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> decomposition;
  if (smallest_pivot) decomposition.setThreshold(*smallest_pivot);
  decomposition.compute(a.transpose());
  const Eigen::MatrixXd directions = decomposition.householderQ();
  return directions.rightCols(a.cols() - decomposition.rank());
}

Eigen::MatrixXd triangular_factor(const Eigen::MatrixXd& a) {
  return Eigen::HouseholderQR<Eigen::MatrixXd>(a).matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

}  // namespace signorini
