#include "certify/quantities/quantity_enclosure.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/LU>

#include "certify/pressure/contact_terms.hpp"
#include "certify/rounding.hpp"
#include "certify/traction_work.hpp"
#include "certify/triangle_sums.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// ‖·‖ of what adds o_T to a field of the given squares, by triangles.
double norm_with(const Eigen::VectorXd& squares, const Eigen::VectorXd& o) {
  return (squares.cwiseSqrt() + o).norm();
}

/// ∫ |∇ 4 λ_a λ_b|² over the triangle behind an edge with the ends a and b.
double square_of_bubble(const Mesh& mesh, int edge) {
  const int t = mesh.edge_triangles[edge][0], e = mesh.local_edge(t, edge);
  const AffineMap map(mesh.corners(t));
  const Eigen::Matrix2d gradients = map.jacobian.inverse().transpose();
  const std::array<Vector, 3> hats{-gradients.rowwise().sum(), gradients.col(0), gradients.col(1)};
  const Vector &a = hats[(e + 1) % 3], &b = hats[(e + 2) % 3];
  return 16 * map.determinant / 2 * (a.squaredNorm() + b.squaredNorm() + a.dot(b)) / 6;
}

}  // namespace

template <int D>
PairSums QuantityEnclosure::sums_of(const std::vector<Term>& terms) const {
  using FieldSums = std::conditional_t<D == 1, MembraneSums, ElasticSums>;
  std::vector<typename FieldSums::Term> all;
  for (const Term& term : terms) {
    const CertifiedSolution& own = term.solution;
    const PairTerm pair{term.factor, own.discrete, own.stress, own.pair.v};
    if constexpr (D == 1)
      all.push_back({pair, own.pair});
    else
      all.push_back({pair, *own.pair.tractions});
  }
  const Discretization& discrete = base_.discrete;
  const FieldSums fields(discrete, std::move(all), norms_);
  PairSums sums(discrete.triangles());
  const auto find = [&](Part part, Progress& own_progress) {
    PairTotals totals;
    FieldSums on(fields);
    LawField<D> law(discrete.problem.material);
    for (int t = part.begin; t < part.end; ++t) {
      own_progress.check_in(t);
      const TriangleSums own = on(t, law, laws_);
      sums.gaps[t] = gap_from_above(own);
      totals.add(own);
    }
    return totals;
  };
  in_parts(discrete.triangles(), progress_, find, [&](const PairTotals& totals) { sums += totals; });
  return sums;
}

PairSums QuantityEnclosure::sums(const std::vector<Term>& terms) const {
  return base_.discrete.spaces().components == 1 ? sums_of<1>(terms) : sums_of<2>(terms);
}

QuantityEnclosure::QuantityEnclosure(const CertifiedSolution& base, PairSums sums, const LawOnMesh& laws,
                                     ShapeNorms& norms, Progress& progress)
    : base_(base),
      laws_(laws),
      norms_(norms),
      progress_(progress),
      everywhere_(base.discrete.triangles(), 0),
      own_(std::move(sums)),
      contact_(contact_work(base.pair.pressure)) {
  const double gap = norm_with(own_.gaps, base.oscillations) + base.carried();
  const double contact = std::max(0., contact_.value + contact_.radius) * (1 + base.loads.change_of_pressure);
  radius_ = std::sqrt(gap * gap + 4 * contact);
}

/// ∫ p (g − v_n).
QuantityEnclosure::Known QuantityEnclosure::contact_work(const ContactPressure& pressure) const {
  Known sum;
  CellBudget budget{ContactTerms::kCells, &progress_};
  const int edges = static_cast<int>(base_.discrete.clearance.edges.size());
  for (int i = 0; i < edges; ++i) {
    if (pressure.at_ends[i][0] == 0 && pressure.at_ends[i][1] == 0) continue;
    budget.share(edges - i, [&](CellBudget& own) {
      const auto [value, radius] =
          ContactTerms(base_.discrete, base_.pair.v, i, own).work(pressure, base_.pair.v);
      sum += {value, radius};
    });
  }
  return sum;
}

QuantityEnclosure::Known QuantityEnclosure::work_of_traction(const Discretization& loads,
                                                             const AdmissibleDisplacement& v) const {
  const TractionWork work = signorini::work_of_traction(loads, v, everywhere_);
  return {work.value, work.slack + kRoundingOfSums * work.size};
}

/// A bound of <p, β> for the β ≥ 0 by which w − η_n may be out of its bounds: bubbles on some edges.
double QuantityEnclosure::beyond_base(const CertifiedSolution& dual) const {
  const Discretization& discrete = base_.discrete;
  double force = 0;
  // A triangle in a corner may have a bubble on two edges, which may strain it alike.
  std::map<int, double> strain;
  for (std::size_t i = 0; i < discrete.clearance.edges.size(); ++i) {
    const ContactEdge& contact = discrete.clearance.edges[i];
    const double b = dual.pair.v.beyond_base(contact);
    if (b == 0) continue;
    const auto& [p, q] = base_.pair.pressure.at_ends[i];
    const int t = discrete.mesh.edge_triangles[contact.edge][0];
    // The mean of the bubble, times a linear pressure; a steep one may be where the bubble is highest.
    const double mean = base_.pair.pressure.steep.contains(contact.edge) ? 1 : 2. / 3;
    force += b * mean * discrete.mesh.length(contact.edge) * (p + q) / 2;
    strain[t] += b * std::sqrt(laws_.whole(t).stiffest * square_of_bubble(discrete.mesh, contact.edge));
  }
  double square = 0;
  for (const auto& [t, norm] : strain) square += norm * norm;
  return (1 + base_.loads.change_of_pressure) * force + radius_ * std::sqrt(square);
}

/// d x + K s is at most this for all d² + s ≤ R²/4.
double QuantityEnclosure::largest_rest(double x, double factor) const {
  if (!std::isfinite(factor)) return factor;
  const double square = radius_ * radius_;
  return factor * radius_ <= x ? radius_ * x / 2 : (x * x / factor + factor * square) / 4;
}

/// With the names of THEORY.md, Theorem 4. Products of both pairs are what the squares of (v, s) + z (η, τ)
/// are more than those of both alone.
QuantityEnclosure::Bounds QuantityEnclosure::operator()(const CertifiedSolution& dual, double z) const {
  const Discretization &discrete = base_.discrete, &loads = dual.discrete;
  const PairSums way = sums({{1, dual}}), end = sums({{1, base_}, {z, dual}});
  const double square = z * z;
  // z (q, v) − z J'(v) η.
  Known sum{own_.energy + square * way.energy - end.energy,
            own_.energy_slack + square * way.energy_slack + end.energy_slack +
                kRoundingOfSums * (own_.strain + std::abs(own_.energy) + end.strain + std::abs(end.energy) +
                                   square * (way.strain + std::abs(way.energy)))};
  sum += z * work_of_traction(discrete, dual.pair.v);
  sum += z * work_of_traction(loads, base_.pair.v);
  const double change = dual.loads.change_of_pressure;
  sum += z * contact_work(dual.pair.pressure);
  sum.radius += z * change * (contact_.value + contact_.radius);
  // ½ z (r, r_Δ)_E.
  sum += {(end.gap - own_.gap - square * way.gap) / 4,
          (end.slack + own_.slack + square * way.slack) / 4 +
              kRoundingOfSums * (end.gap + own_.gap + square * way.gap)};

  const Eigen::VectorXd of_dual = way.gaps.cwiseSqrt() + dual.oscillations,
                        of_base = own_.gaps.cwiseSqrt() + base_.oscillations;
  const double x = of_dual.norm() + dual.carried(),
               factor =
                   (std::max(dual.pair.v.factor(), dual.pair.pressure.factor_beside(base_.pair.pressure)) +
                    change) /
                   (1 - base_.loads.change_of_pressure);
  const double radius = sum.radius / z +
                        (base_.unbalanced() * x + std::sqrt(own_.gaps.sum()) * dual.unbalanced()) / 2 +
                        beyond_base(dual) + largest_rest(x, factor);
  return {sum.value / z - radius, sum.value / z + radius, radius_ > 0 ? x / radius_ : 0, factor,
          of_base.cwiseProduct(of_dual)};
}

}  // namespace signorini
