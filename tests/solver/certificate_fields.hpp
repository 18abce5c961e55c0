#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "certify/admissible_pair.hpp"
#include "certify/displacement/relaxation.hpp"
#include "certify/membrane/stream_function_minimization.hpp"
#include "certify/shape_norms.hpp"
#include "contact/active_set.hpp"
#include "contact/condense.hpp"
#include "problems/membrane.hpp"
#include "result/summarize.hpp"
#include "system/hybrid_system.hpp"
#include "system/recovery.hpp"

namespace signorini {

/// Gauss–Legendre on [0, 1].
struct GaussRule {
  static constexpr int size = 20;
  std::array<double, size> points, weights;

  GaussRule() {
    for (int i = 0; i < size; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (size + 0.5)), slope = 0;
      for (int step = 0; step < 8; ++step) {
        double before = 1, value = x;
        for (int k = 2; k <= size; ++k)
          before = std::exchange(value, ((2 * k - 1) * x * value - (k - 1) * before) / k);
        slope = size * (x * value - before) / (x * x - 1);
        x -= value / slope;
      }
      points[i] = (1 + x) / 2;
      weights[i] = 1 / ((1 - x * x) * slope * slope);
    }
  }
};

inline const GaussRule gauss;

/// ∫ f ds from a to b; exact enough for half-integer powers of the distance from a too.
template <typename Function>
double integrate_from(const Point& a, const Point& b, const Function& f) {
  double sum = 0;
  for (int i = 0; i < GaussRule::size; ++i) {
    const double t = gauss.points[i], s = t * t;
    sum += gauss.weights[i] * 2 * t * f(s);
  }
  return sum * (b - a).norm();
}

/// ∫ f(reference point) over the reference triangle, from one of its corners; exact enough for half-integer
/// powers of the distance from the corner, and for functions that jump from ray to ray there.
template <typename Function>
double integrate_from(int corner, const Function& f) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  const Point &a = corners[corner], &b = corners[(corner + 1) % 3], &c = corners[(corner + 2) % 3];
  double sum = 0;
  for (int i = 0; i < GaussRule::size; ++i)
    for (int j = 0; j < GaussRule::size; ++j) {
      const double t = gauss.points[i], r = t * t, s = gauss.points[j];
      const Point far = (1 - s) * b + s * c;
      sum += gauss.weights[i] * gauss.weights[j] * 2 * t * r * f(Point(a + r * (far - a)));
    }
  return sum;
}

/// The certificate's fields for a membrane, rebuilt from its ingredients: v, σ* and p*.
class CertificateFields {
 public:
  CertificateFields(const Problem& problem, const std::shared_ptr<const Mesh>& mesh)
      : mesh_(mesh), discretization_(problem, *mesh), progress_(observer_, std::nullopt) {
    const HybridSystem system = assemble(discretization_, progress_);
    const Operator made(mesh, discretization_.clearance, system.matrix, false, Factorization::multifrontal,
                        progress_);
    CondensedContact condensed(made, system.right, progress_);
    const ContactResult found = active_set(condensed.contact(), {}, progress_);
    const Eigen::VectorXd x = condensed.traces(found.clearance, progress_);
    Recovered fields = recover(discretization_, x, progress_);
    Fields all{std::move(fields.stress), std::move(fields.displacement), found.clearance, x, found.outcome};
    solution_ = describe(discretization_, mesh, all, {ActiveSet{}, std::nullopt}, progress_);
    ShapeNorms norms;
    add_bound(
        problem, [&] { return certify(discretization_, solution_, x, norms, progress_); }, solution_,
        progress_);
    const Eigen::VectorXd clearance = discretization_.clearance.clearance(found.clearance);
    pair_.emplace(AdmissiblePair{{discretization_, solution_, x, progress_},
                                 {discretization_, solution_.stress, clearance}});
    pair_->v.relax(work_of_loads(discretization_, progress_), kStepsFromAverage, progress_);
    minimize_stream_function(discretization_, pair_->v, clearance, pair_->pressure, progress_);
    pair_->of_balance = stream_function_of_balance(discretization_, progress_);
  }

  const Discretization& discretization() const { return discretization_; }
  const Solution& solution() const { return solution_; }
  const AdmissiblePair& pair() const { return *pair_; }
  Progress& progress() { return progress_; }
  const Mesh& mesh() const { return discretization_.mesh; }
  const ErrorBound& bound() const { return solution_.summary.error_bound.value(); }
  const std::vector<ContactEdge>& contact_edges() const { return discretization_.clearance.edges; }

  /// The corner of the triangle from which ∇v and ∇u are smooth: the singular point, or the one opposite a
  /// lifted edge.
  int corner_to_integrate_from(int t) const {
    for (int e = 0; e < 3; ++e) {
      const bool is_boundary = mesh().edge_triangles[mesh().triangle_edges[t][e]][1] < 0;
      if ((is_boundary && pair_->v.is_lifted(t)) || mesh().corners(t)[e].norm() == 0) return e;
    }
    return 0;
  }

  /// σ_h.
  Vector stress(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    return discretization_.spaces().row.values(map, reference) * solution_.stress.col(t);
  }

  /// σ* but for the balance, which has no traction on the edges inside.
  Vector admissible_stress(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    const Vector rise = map.jacobian.inverse().transpose() *
                        (quadratic_gradients(reference) * pair_->stream_function_on(mesh(), t).transpose());
    return stress(t, reference) + Vector(rise.y(), -rise.x());
  }

  Vector slope(int t, const Point& reference) const {
    const AffineMap map(mesh().corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    Tensor<1> slope = inverse.transpose() * (quadratic_gradients(reference) * pair_->v.on<1>(t).transpose());
    Eigen::Matrix<double, 1, 1> value = Eigen::Matrix<double, 1, 1>::Zero();
    pair_->v.add_lifts<1>(t, reference, inverse, value, slope);
    return slope;
  }

  double pressure(int i, double s) const {
    return (1 - s) * pair_->pressure.at_ends[i][0] + s * pair_->pressure.at_ends[i][1];
  }
  double room(int i, double s) const { return pair_->v.room(contact_edges()[i], s); }

 private:
  std::shared_ptr<const Mesh> mesh_;
  Discretization discretization_;
  Observer observer_;
  Progress progress_;
  Solution solution_;
  std::optional<AdmissiblePair> pair_;
};

}  // namespace signorini
