#include "certify/data/jump_oscillation.hpp"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "certify/data/linear_remainder.hpp"
#include "certify/data/local_equilibrium.hpp"
#include "fem/lagrange.hpp"
#include "fem/projection.hpp"
#include "fem/small_matrices.hpp"
#include "mesh/refine.hpp"

namespace signorini {
namespace {

/// An elastic body gains little by more, and its stresses take longer to set up than a small solve.
template <int D>
constexpr int kCuts = D == 1 ? 3 : 2;
template <int D>
constexpr int kPieces = 1 << (2 * kCuts<D>);

/// What the integrals on the pieces may be off by, relative to the mean of f − Πf: it costs as much of the
/// bound.
constexpr double kJumpTolerance = 5e-4;

/// The least stress on a reference triangle without traction, for loads that are linear on each of its
/// pieces.
template <int D>
class PiecewiseLoads {
 public:
  /// The values of a load at the corners of the pieces, the components of a corner together.
  using Values = Eigen::Matrix<double, 3 * D * kPieces<D>, 1>;

  explicit PiecewiseLoads(const ReferenceTriangle& triangle)
      : pieces_(refine(make_mesh({triangle.corners.begin(), triangle.corners.end()}, {{0, 1, 2}}, {""},
                                 {{{1, 2}, 0}, {{2, 0}, 0}, {{0, 1}, 0}}),
                       kCuts<D>)) {
    const LocalEquilibrium<D> stresses(pieces_);
    linear_ = stresses.linear;
    const Eigen::MatrixXd moments = linear_.transpose() * stresses.mass;
    onto_linear_ = solve_definite(moments * linear_, moments);
    // The least zᵀ energy z with loads z = r is rᵀ S⁺ r, S = loads energy⁻¹ loadsᵀ. S is 0 on the work of
    // rigid motions, which r does not do.
    const Eigen::MatrixXd work = stresses.mass * rigid(linear_);
    const Eigen::MatrixXd own = stresses.loads * solve_definite(stresses.energy, stresses.loads.transpose());
    root_.compute(own + own.trace() / work.squaredNorm() * work * work.transpose());
  }

  const Mesh& pieces() const { return pieces_; }

  /// ‖τ‖ for r − Π₁r.
  double least_stress(const Values& load) const {
    const Eigen::VectorXd rest = load - linear_ * (onto_linear_ * load);
    return root_.matrixL().solve(rest).norm();
  }

 private:
  /// The rigid motions out of the linear ones, LocalEquilibrium::linear.
  static Eigen::MatrixXd rigid(const Eigen::MatrixXd& linear) {
    if constexpr (D == 1) return linear.leftCols(1);
    Eigen::MatrixXd all(linear.rows(), 3);
    all << linear.leftCols(2), linear.col(4) - linear.col(3);
    return all;
  }

  Mesh pieces_;
  Eigen::MatrixXd linear_, onto_linear_;
  Eigen::LLT<Eigen::MatrixXd> root_;
};

template <int D>
const PiecewiseLoads<D>& piecewise_loads(int reference) {
  if (reference == 0) {
    static const PiecewiseLoads<D> of_half_square(reference_triangles()[0]);
    return of_half_square;
  }
  static const PiecewiseLoads<D> of_unit_sides(reference_triangles()[1]);
  return of_unit_sides;
}

}  // namespace

template <int D>
double jump_oscillation(const VectorField& load, const ProjectedLoad& projected,
                        const std::array<Point, 3>& corners, CellBudget& budget) {
  const ReferenceMap map = nearest_reference<D>(corners);
  const PiecewiseLoads<D>& loads = piecewise_loads<D>(map.reference);
  const Mesh& pieces = loads.pieces();
  const AffineMap whole(corners);
  const Point &origin = corners[map.first],
              reference_origin = reference_triangles()[map.reference].corners[0];
  const double area = whole.determinant / 2, mean = projected.unbalanced / std::sqrt(area);
  typename PiecewiseLoads<D>::Values values;
  double rest_square = 0, uncertain_square = 0;
  for (int s = 0; s < kPieces<D>; ++s) {
    std::array<Point, 3> own;
    for (int z = 0; z < 3; ++z) own[z] = origin + map.jacobian * (pieces.corners(s)[z] - reference_origin);
    // Πf at the nodes of P2 on the piece.
    ProjectedLoad::Nodes balanced(D, 6);
    for (int node = 0; node < 6; ++node) {
      const Point x = node < 3 ? own[node] : Point((own[(node + 1) % 3] + own[(node + 2) % 3]) / 2);
      balanced.col(node) =
          projected.balanced * quadratic_basis(whole.jacobian.inverse() * (x - whole.origin));
    }
    Eigen::Matrix<double, D, 3> linear;
    double own_uncertain = 0;
    for (int c = 0; c < D; ++c) {
      Projection of_load;
      budget.share(D * (kPieces<D> - s) - c, [&](CellBudget& part) {
        of_load = project(load.fields()[c], own, {kJumpTolerance * mean, kJumpTolerance * mean}, part);
      });
      const Projection::Nodes of_balanced = balanced.row(c), linear_of_balanced = linear_part(of_balanced);
      linear.row(c) = (of_load.linear - linear_of_balanced).template head<3>();
      const double rest = of_load.beyond_linear + norm(of_balanced - linear_of_balanced);
      rest_square += whole.determinant / kPieces<D> * rest * rest;
      own_uncertain += of_load.uncertain_force;
    }
    // A linear φ on a triangle has max |φ| ≤ 3 ‖φ‖ / √area.
    uncertain_square += 9 * whole.determinant / kPieces<D> * 2 * own_uncertain * own_uncertain;
    if constexpr (D == 2) linear = map.jacobian.inverse() * linear;
    values.template segment<3 * D>(3 * D * s) = linear.reshaped();
  }
  const double constant = linear_remainder<D>(corners);
  // (r, w) = det B (B⁻¹ r, ŵ), and ‖ε(ŵ)‖ ≤ ‖B‖² ‖ε(w)‖ / √det B.
  const double to_triangle = std::sqrt(map.jacobian.determinant()) * std::pow(map.stretch, D);
  return to_triangle * loads.least_stress(values) + constant / (1 << kCuts<D>)*std::sqrt(rest_square) +
         constant * std::sqrt(uncertain_square);
}

template double jump_oscillation<1>(const VectorField&, const ProjectedLoad&, const std::array<Point, 3>&,
                                    CellBudget&);
template double jump_oscillation<2>(const VectorField&, const ProjectedLoad&, const std::array<Point, 3>&,
                                    CellBudget&);

}  // namespace signorini
