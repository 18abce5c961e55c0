#include "certify/energy_norm.hpp"

#include <span>

#include "certify/local_fields.hpp"

namespace signorini {
namespace {

/// ∫ τ·Cτ over the piece of a triangle by a rule, with what that may miss: of two quadratic forms that differ
/// by at most η times themselves each integral is at most (1 + η) / (1 − η) times the other's; where η tells
/// too little, as on a cell through which the law jumps, C is at most the softest.
template <int D>
double square_on(const Discretization& discrete, const Eigen::MatrixXd& stress, int t,
                 const TrianglePiece& place, const LawPiece& piece, double tolerance, LawField<D>& law) {
  const int of_fields = discrete.spaces().order + 1;
  const int degree = piece.degree_of_rule(of_fields, tolerance);
  const double error = piece.error_of_rule(degree, of_fields);
  const bool is_known = error < 0.5;
  const AffineMap map(discrete.mesh.corners(t));
  std::vector<Point> points;
  for (const auto& [point, weight] : rule_of_degree(degree)) points.push_back(place(point));
  const StressValues<D> values(discrete.spaces(), points);
  double sum = 0;
  for (std::size_t q = 0; q < points.size(); ++q) {
    const Tensor<D> tau = values(static_cast<int>(q), map, stress.col(t));
    const double weight = rule_of_degree(degree)[q].weight * place.share * map.determinant;
    sum += weight *
           (is_known ? tau.dot(law(map(points[q])).compliance * tau) : piece.softest * tau.squaredNorm());
  }
  return is_known ? sum * (1 + error) / (1 - error) : sum;
}

template <int D>
Eigen::VectorXd squares(const Discretization& discrete, const Eigen::MatrixXd& stress, const LawOnMesh& laws,
                        Progress& progress) {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(discrete.triangles());
  LawField<D> law(discrete.problem.material);
  const TrianglePiece whole{{Point(0, 0), Point(1, 0), Point(0, 1)}, 1, {}};
  for (int t = 0; t < discrete.triangles(); ++t) {
    progress.check_in(t);
    const std::vector<LawPiece> cut = laws.cut(t);
    const std::span<const LawPiece> pieces = cut.empty() ? std::span(&laws.whole(t), 1) : std::span(cut);
    for (const LawPiece& piece : pieces)
      all[t] +=
          square_on<D>(discrete, stress, t, cut.empty() ? whole : piece.place, piece, laws.tolerance(), law);
  }
  return all;
}

}  // namespace

Eigen::VectorXd energy_norm_squares(const Discretization& discrete, const Eigen::MatrixXd& stress,
                                    const LawOnMesh& laws, Progress& progress) {
  return discrete.spaces().components == 1 ? squares<1>(discrete, stress, laws, progress)
                                           : squares<2>(discrete, stress, laws, progress);
}

}  // namespace signorini
