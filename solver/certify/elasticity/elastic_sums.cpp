#include <algorithm>
#include <cmath>

#include <cblas.h>

#include "certify/data/balanced_load.hpp"
#include "certify/elasticity/johnson_mercier_data.hpp"
#include "certify/triangle_sums.hpp"

namespace signorini {
namespace {

/// Stresses are of degree 3.
int degree_of_fields(bool lifted) {
  return std::max(3, lifted ? Lift::kDegreeInside - 1 : 1);
}

}  // namespace

ElasticSums::ElasticSums(const Discretization& discrete, const Solution& solution,
                         const AdmissibleDisplacement& v, const EdgeTractions& tractions, ShapeNorms& norms)
    : ElasticSums(discrete, {{{1, discrete, solution.stress, v}, tractions}}, norms) {
  needs_all_ = true;
}

ElasticSums::ElasticSums(const Discretization& discrete, std::vector<Term> terms, ShapeNorms& norms)
    : discrete_(discrete),
      terms_(std::move(terms)),
      has_load_(std::ranges::any_of(terms_, [](const Term& term) { return term.discrete.body.is_any(); })),
      norms_(norms) {
  norms_.look_over(discrete);
}

ElasticSums::Given ElasticSums::given_on(int t, const AffineMap& map) const {
  Given sum{JohnsonMercierData::Zero(), LocalVector::Zero(terms_[0].stress.rows()),
            displacement_on<2>(terms_, t).reshaped()};
  for (const Term& term : terms_) {
    sum.data += term.factor * johnson_mercier_data(term.discrete, term.tractions, t, map);
    sum.stress += term.factor * term.stress.col(t);
  }
  return sum;
}

/// What is lifted into the triangle, at the points of a rule: values, and strains.
ElasticSums::Lifted ElasticSums::lifted_on(int t, const AffineMap& map,
                                           const JohnsonMercierRule& rule) const {
  Lifted lifted;
  if (!is_lifted(terms_, t)) return lifted;
  for (const JohnsonMercier::Place& place : rule.places) {
    Eigen::Vector2d value = Eigen::Vector2d::Zero();
    Tensor<2> slope = Tensor<2>::Zero();
    add_lifts<2>(terms_, t, place.point, map.jacobian.inverse(), value, slope);
    lifted.values.push_back(value);
    lifted.strains.push_back(mandel(slope));
  }
  return lifted;
}

/// (Πf, v), and what (f − Πf, v) is at most: f − Πf is orthogonal to v_h, where that is quadratic, and does
/// no more work on the rest of v than the product of their norms.
void ElasticSums::add_work_of_load(int t, const AffineMap& map, const Quadratic<2>& displacement,
                                   const Found& found, TriangleSums& sums) const {
  if (!has_load_) return;
  const ProjectedLoad load = load_on(terms_, t);
  const Quadratic<2> quadratic = load.projection;
  const auto at_inner = found.inner.reshaped(2, JohnsonMercierRule::kInner);
  const InnerMass& mass = inner_mass();
  const double work =
      map.determinant *
      quadratic.cwiseProduct(displacement * quadratic_mass() + at_inner * mass.with_quadratic.transpose())
          .sum();
  const double rest_square = is_lifted(terms_, t)
                                 ? found.rest_square
                                 : map.determinant * (at_inner * mass.inner).cwiseProduct(at_inner).sum();
  sums.energy -= work + found.work_on_lifts;
  sums.energy_slack +=
      load.rest * std::sqrt(rest_square) + load.uncertain_work * bound_of_quadratic(displacement);
}

void ElasticSums::add_rest_of_lifts(int t, const AffineMap& map, const LawPiece& law,
                                    TriangleSums& sums) const {
  const AdmissibleDisplacement::LiftRest rest = rest_of_lifts(terms_, t);
  if (rest.slope == 0) return;
  const ProjectedLoad load = load_on(terms_, t);
  const double area = map.determinant / 2, zeta = rest.slope * std::sqrt(area * law.stiffest);
  sums.energy_slack += zeta * (std::sqrt(2 * sums.strain + sums.slack) + zeta / 2) +
                       rest.value * (std::sqrt(area) * load.rest + area * load.projection.norm());
  sums.add_unknown_strain(zeta);
}

/// Of the triangle and all others of its shape that come soon after: many columns in one product take a
/// fraction of the time.
const ElasticSums::Found& ElasticSums::by_norms(int t, const JohnsonMercierNorms& norms) {
  const auto place = [this](int triangle) -> Found& { return found_[triangle % kAhead]; };
  if (place(t).triangle == t) return place(t);
  std::vector<int> alike;
  const int end = std::min(t + kAhead, discrete_.triangles());
  for (int other = t; other < end; ++other)
    if (!is_lifted(terms_, other) && norms_.made(AffineMap(discrete_.mesh.corners(other))) == &norms)
      alike.push_back(other);
  const auto count = static_cast<Eigen::Index>(alike.size());
  Eigen::MatrixXd z(norms.gap.cols(), count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Given given = given_on(alike[i], AffineMap(discrete_.mesh.corners(alike[i])));
    z.col(i) << given.data, given.stress, given.displacement;
  }
  const auto squares = [](const Eigen::MatrixXd& factor, Eigen::MatrixXd part) -> Eigen::VectorXd {
    const int rows = static_cast<int>(part.rows()), columns = static_cast<int>(part.cols());
    cblas_dtrmm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, rows, columns, 1,
                factor.data(), rows, part.data(), rows);
    return part.colwise().squaredNorm();
  };
  const Eigen::Index stresses = norms.correction.cols(), of_scheme = norms.stress.cols();
  const Eigen::VectorXd gap = squares(norms.gap, z), strain = squares(norms.strain, z) / 2;
  const Eigen::VectorXd stress = squares(norms.stress, z.middleRows(stresses - of_scheme, of_scheme));
  Eigen::VectorXd direct_gap, correction, skew;
  if (needs_all_) {
    direct_gap = squares(norms.direct_gap, z);
    correction = squares(norms.correction, z.topRows(stresses));
    skew = squares(norms.skew, z.middleRows(stresses - of_scheme, of_scheme));
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    Found& found = place(alike[i]);
    found.triangle = alike[i];
    if (has_load_) found.inner = norms.inner * z.col(i);
    TriangleSums& sums = found.sums = {};
    sums.gap = gap[i];
    sums.strain = sums.energy = strain[i];
    sums.stress = stress[i];
    if (!needs_all_) continue;
    sums.direct_gap = direct_gap[i];
    sums.correction = correction[i];
    sums.skew = skew[i];
  }
  return place(t);
}

/// What the points of a rule add, when the fields are found. `error_of_whole`: of a rule for the whole
/// triangle.
void ElasticSums::add_points(int t, const AffineMap& map, const OnRule& on, double error_of_whole,
                             Found& found) const {
  const JohnsonMercierRule& rule = on.rule;
  const JohnsonMercierOperators<1> values(rule, map, on.values, on.laws);
  TriangleSums& sums = found.sums;
  sums.gap += values.gap.squaredNorm();
  sums.direct_gap += values.direct_gap.squaredNorm();
  sums.correction += values.correction.squaredNorm();
  sums.skew += values.skew.squaredNorm();
  sums.stress += values.stress.squaredNorm();
  const double strain = values.strain.squaredNorm() / 2;
  sums.strain += strain;
  sums.energy += strain;
  // What the law has beyond a polynomial counts twice, in the integral and in the rule.
  for (int q = 0; q < rule.size(); ++q) {
    const double error = rule.errors.empty() ? error_of_whole : rule.errors[q];
    const double of_strain = values.strain.middleRows<3>(3 * q).squaredNorm();
    sums.slack += 2 * error *
                  (2 * values.stress.middleRows<4>(4 * q).squaredNorm() +
                   3 * values.correction.middleRows<3>(3 * q).squaredNorm() + of_strain);
    sums.energy_slack += error * of_strain;
  }
  if (on.lifted.values.empty() || !has_load_) return;
  const Quadratic<2> load = load_on(terms_, t).projection;
  for (int q = 0; q < rule.size(); ++q) {
    const double weight = rule.places[q].weight * map.determinant;
    const Eigen::Vector2d& lift = on.lifted.values[q];
    const Eigen::Vector2d rest =
        lift + found.inner.reshaped(2, JohnsonMercierRule::kInner) *
                   rule.places[q].displacement_basis.tail<JohnsonMercierRule::kInner>();
    found.work_on_lifts += weight * (load * rule.values[q].basis).dot(lift);
    found.rest_square += weight * rest.squaredNorm();
  }
}

/// By a rule for the whole triangle, or by those of its pieces: of many, by one after the other, and twice,
/// for all their points together may take tens of megabytes.
ElasticSums::Found ElasticSums::by_points(int t, const AffineMap& map, std::span<const LawPiece> pieces,
                                          int of_fields, LawField<2>& law, const LawOnMesh& laws) {
  const Spaces& spaces = discrete_.spaces();
  const int degree = laws.whole(t).degree_of_rule(of_fields, laws.tolerance());
  const double error_of_whole = laws.whole(t).error_of_rule(degree, of_fields);
  JohnsonMercierFields<1> fields(map, given_on(t, map));
  const auto on = [&](const JohnsonMercierRule& rule) -> OnRule {
    return {rule, laws_at(discrete_, rule, map, law), lifted_on(t, map, rule), {}};
  };
  const auto fill = [&](std::span<const LawPiece> from) {
    return rule_of_pieces_.fill(spaces, from, of_fields, laws.tolerance());
  };
  Found found;
  if (pieces.empty() || fill(pieces) == pieces.size()) {
    OnRule only = on(pieces.empty() ? johnson_mercier_rule(spaces, degree) : rule_of_pieces_);
    only.values = minimized(fields, only.rule, only.laws, only.lifted.strains);
    found.inner = fields.inner();
    add_points(t, map, only, error_of_whole, found);
    return found;
  }
  const auto for_each_rule = [&](const auto& step) {
    for (std::span<const LawPiece> rest = pieces; !rest.empty();) {
      rest = rest.subspan(fill(rest));
      OnRule part = on(rule_of_pieces_);
      part.values = fields.on(part.rule, part.lifted.strains);
      step(part);
    }
  };
  for_each_rule([&](const OnRule& part) { fields.add(part.rule, part.laws, part.values); });
  fields.minimize();
  found.inner = fields.inner();
  for_each_rule([&](const OnRule& part) { add_points(t, map, part, error_of_whole, found); });
  return found;
}

TriangleSums ElasticSums::operator()(int t, LawField<2>& law, const LawOnMesh& laws) {
  const AffineMap map(discrete_.mesh.corners(t));
  const bool lifted = is_lifted(terms_, t), constant_law = discrete_.element.has_constant_material();
  const auto* norms = lifted || !constant_law ? nullptr : norms_.elastic(map, discrete_.spaces(), law);
  const Found found =
      norms ? by_norms(t, *norms) : by_points(t, map, laws.cut(t), degree_of_fields(lifted), law, laws);
  TriangleSums sums = found.sums;
  const Quadratic<2> displacement = displacement_on<2>(terms_, t);
  add_work_of_load(t, map, displacement, found, sums);
  add_rest_of_lifts(t, map, laws.whole(t), sums);
  sums.add_rounding(map, laws.whole(t), bound_of_quadratic(displacement));
  return sums;
}

}  // namespace signorini
