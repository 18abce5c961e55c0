#include "certify/data/motion_differences.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "certify/data/linear_remainder.hpp"
#include "fem/couple.hpp"
#include "system/dissection.hpp"
#include "system/multifrontal.hpp"

namespace signorini {
namespace {

/// So many steps find the least quotient within some per cent; less than it is proved by a factorisation.
constexpr int kMotionSteps = 12;
constexpr double kBelow = 0.9;
constexpr int kMostTries = 12;

/// The motions of triangles: a + b ẑ × (x − x_T) / ρ_T, |x − x_T| ≤ ρ_T, or a constant of a membrane.
template <int D>
class Motions {
 public:
  static constexpr int kOwn = D == 1 ? 1 : 3;

  Motions(const Discretization& discrete, const LawOnMesh& laws, const UncertainLoads& loads,
          std::optional<int> held)
      : discrete_(discrete), mesh_(discrete.mesh), laws_(laws), loads_(loads), held_(held) {
    for (int t = 0; t < discrete.triangles(); ++t)
      remainders_.push_back(motion_remainder<D>(mesh_.corners(t)));
    for (const BoundaryPart& part : mesh_.boundary)
      if (condition_on<Fixed>(discrete.problem, part.name))
        for (const int edge : part.edges) is_fixed_[edge] = true;
  }

  double bound(Progress& progress) const {
    double forces = 0, beyond_square = 0;
    for (int t = 0; t < discrete_.triangles(); ++t) {
      forces += force_on(t);
      beyond_square += std::pow(beyond_motion(t), 2);
    }
    if (forces == 0) return 0;
    const double least = least_quotient(progress);
    return std::sqrt(beyond_square) +
           (least > 0 ? std::sqrt(forces / least) : std::numeric_limits<double>::infinity());
  }

 private:
  double force_on(int t) const {
    const auto& on_edges = loads_.on_edges[t];
    return loads_.on_triangles[t] + on_edges[0] + on_edges[1] + on_edges[2];
  }

  /// Linear functions on a triangle have max |φ| ≤ 3 ‖φ‖ / √|T|, on an edge 2 ‖φ‖ / √|e|.
  double beyond_motion(int t) const {
    const MotionRemainder& remainder = remainders_[t];
    double sum = 3 * loads_.on_triangles[t] * remainder.on_triangle / std::sqrt(area(t));
    for (int e = 0; e < 3; ++e)
      sum += 2 * loads_.on_edges[t][e] * remainder.on_edges[e] /
             std::sqrt(mesh_.length(mesh_.triangle_edges[t][e]));
    return sum * std::sqrt(laws_.whole(t).softest);
  }

  double area(int t) const { return AffineMap(mesh_.corners(t)).determinant / 2; }

  double reach(int t) const {
    double most = 0;
    for (const Point& corner : mesh_.corners(t)) most = std::max(most, (corner - mesh_.centroid(t)).norm());
    return most;
  }

  bool counts(int edge) const { return mesh_.edge_triangles[edge][1] >= 0 || is_fixed_[edge]; }

  double edges_that_count(int t) const {
    return static_cast<double>(
        std::ranges::count_if(mesh_.triangle_edges[t], [this](int edge) { return counts(edge); }));
  }

  /// What the motion of a triangle is at a point.
  Eigen::Matrix<double, D, kOwn> motion_at(int t, const Point& x) const {
    Eigen::Matrix<double, D, kOwn> motion;
    if constexpr (D == 1)
      motion.setOnes();
    else
      motion << Eigen::Matrix2d::Identity(), turned_left(x - mesh_.centroid(t)) / reach(t);
    return motion;
  }

  /// max_T |R_T v|² is at most a sum of squares of its numbers: |a + b|² ≤ 5/4 |a|² + 5 |b|².
  static Eigen::Matrix<double, kOwn, 1> largest_square() {
    Eigen::Matrix<double, kOwn, 1> factors;
    if constexpr (D == 1)
      factors.setOnes();
    else
      factors << 1.25, 1.25, 5;
    return factors;
  }

  using OfPair = Eigen::Matrix<double, 2 * kOwn, 2 * kOwn>;

  /// The numbers of a triangle's motion are those from here on; -1 of one that is held.
  int first(int t) const {
    if (t < 0 || t == held_) return -1;
    return kOwn * (held_ && t > *held_ ? t - 1 : t);
  }

  int size() const { return kOwn * (discrete_.triangles() - (held_ ? 1 : 0)); }

  /// Σ_e ‖R_T v − R_T' v‖²_e / w_e − shift Σ F_T max |R_T v|².
  ElementSum quotient(double shift) const {
    ElementSum sum;
    sum.size = size();
    sum.per_element = 2 * kOwn;
    const std::size_t edges = mesh_.edges.size();
    sum.unknowns.reserve(edges * 2 * kOwn);
    sum.matrix_of.reserve(edges);
    sum.centres.reserve(edges);
    for (int edge = 0; edge < static_cast<int>(mesh_.edges.size()); ++edge) {
      if (!counts(edge)) continue;
      OfPair own = of_edge(edge);
      const auto& triangles = mesh_.edge_triangles[edge];
      // The edges of a triangle share what is taken off for it.
      for (int side = 0; side < 2; ++side)
        if (const int t = triangles[side]; t >= 0)
          own.diagonal().template segment<kOwn>(side * kOwn) -=
              shift * force_on(t) / edges_that_count(t) * largest_square();
      add(sum, triangles, own, middle(edge));
    }
    return sum;
  }

  void add(ElementSum& sum, const std::array<int, 2>& triangles, const OfPair& matrix,
           const Point& centre) const {
    for (const int t : triangles)
      for (int k = 0; k < kOwn; ++k) sum.unknowns.push_back(first(t) < 0 ? -1 : first(t) + k);
    sum.matrix_of.push_back(sum.keep(matrix.data()));
    sum.centres.push_back(centre);
  }

  /// ‖R_T v − R_T' v‖²_e / w_e.
  OfPair of_edge(int edge) const {
    const auto& [one, other] = mesh_.edge_triangles[edge];
    double weight = 0;
    Eigen::Matrix<double, 2 * D, 2 * kOwn> at_ends = decltype(at_ends)::Zero();
    for (const int t : {one, other}) {
      if (t < 0) continue;
      weight += edges_that_count(t) * laws_.whole(t).softest *
                std::pow(remainders_[t].on_edges[mesh_.local_edge(t, edge)], 2);
      for (int end = 0; end < 2; ++end)
        at_ends.template block<D, kOwn>(D * end, t == one ? 0 : kOwn) =
            (t == one ? 1 : -1) * motion_at(t, mesh_.points[mesh_.edges[edge][end]]);
    }
    // The integral of the square of a linear function.
    const auto first = at_ends.template topRows<D>(), last = at_ends.template bottomRows<D>();
    return mesh_.length(edge) / weight / 6 *
           (first.transpose() * first + last.transpose() * last +
            (first + last).transpose() * (first + last));
  }

  Point middle(int edge) const {
    return (mesh_.points[mesh_.edges[edge][0]] + mesh_.points[mesh_.edges[edge][1]]) / 2;
  }

  /// A number that no quotient is below, and hardly above which the least is; 0 if doubles do not tell.
  double least_quotient(Progress& progress) const {
    try {
      double known = kBelow * foreseen(progress);
      if (!std::isfinite(known)) return 0;
      for (int tries = 0; known > 0 && tries < kMostTries; ++tries, known /= 2)
        if (is_below_all(known, progress)) return known;
    } catch (const NotPositiveDefinite&) {
      // Nor is the left side by itself, but for rounding.
    }
    return 0;
  }

  /// Whether a factor would be several times that of ordinary triangles, as it is of slivers: more than the
  /// solve is foreseen to have for it (run/memory_estimate.cpp).
  bool fills_in(const ElementSum& differences, Progress& progress) const {
    const double n = discrete_.triangles(), ordinary = 1.5 * n * std::log2(n + 2), most = 3 * ordinary;
    double numbers = 0;
    const Dissection order(differences, 0, progress);
    order.for_each_piece([&](int piece) {
      const Dissection::Front front = order.front(piece);
      numbers += static_cast<double>(front.pivots) * front.size();
    });
    return numbers > kOwn * kOwn * most;
  }

  std::optional<Factor> factor_of_differences(Progress& progress) const {
    const ElementSum differences = quotient(0);
    if (fills_in(differences, progress)) return std::nullopt;
    return multifrontal(differences, 0, progress);
  }

  bool is_below_all(double number, Progress& progress) const {
    try {
      multifrontal(quotient(number), 0, progress);
      return true;
    } catch (const NotPositiveDefinite&) {
      return false;
    }
  }

  /// By the inverse iteration; 0 where slivers do not let it.
  double foreseen(Progress& progress) const {
    Eigen::VectorXd squares = Eigen::VectorXd::Zero(size());
    for (int t = 0; t < discrete_.triangles(); ++t)
      if (first(t) >= 0) squares.segment<kOwn>(first(t)) = force_on(t) * largest_square();
    const std::optional<Factor> factor = factor_of_differences(progress);
    if (!factor) return 0;
    Factor::Workspace workspace;
    std::mt19937 engine(1);
    Eigen::VectorXd motion(size());
    for (double& own : motion) own = std::uniform_real_distribution<>(0.5, 1)(engine);
    double quotient = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMotionSteps; ++step) {
      const Eigen::VectorXd work = squares.cwiseProduct(motion);
      motion = work;
      factor->solve(motion, workspace, progress);
      const double square = squares.dot(motion.cwiseAbs2());
      quotient = motion.dot(work) / square;
      motion /= std::sqrt(square);
    }
    return quotient;
  }

  const Discretization& discrete_;
  const Mesh& mesh_;
  const LawOnMesh& laws_;
  const UncertainLoads& loads_;
  const std::optional<int> held_;
  std::vector<MotionRemainder> remainders_;
  std::vector<bool> is_fixed_ = std::vector<bool>(mesh_.edges.size(), false);
};

}  // namespace

double carried_by_motions(const Discretization& discrete, const LawOnMesh& laws, const UncertainLoads& loads,
                          std::optional<int> held, Progress& progress) {
  return discrete.spaces().components == 1 ? Motions<1>(discrete, laws, loads, held).bound(progress)
                                           : Motions<2>(discrete, laws, loads, held).bound(progress);
}

}  // namespace signorini
