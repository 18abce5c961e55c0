#include "certify/elasticity/johnson_mercier_operators.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

constexpr int kInner = JohnsonMercierRule::kInner;
constexpr double kHalf = std::numbers::sqrt2 / 2;  ///< √½

/// Mandel's strain of v = Σ φ_i v_i from the gradients of the φ_i, the components of v in turns.
template <int Nodes>
Eigen::Matrix<double, 3, 2 * Nodes> strains(const Eigen::Matrix<double, 2, Nodes>& gradients) {
  Eigen::Matrix<double, 3, 2 * Nodes> strain;
  for (int i = 0; i < Nodes; ++i)
    strain.template middleCols<2>(2 * i) << gradients(0, i), 0, 0, gradients(1, i), kHalf * gradients(1, i),
        kHalf * gradients(0, i);
  return strain;
}

/// (xx, yy, √2 xy) and the skew part (xy − yx) / √2 of σ_h from its coefficients, the rows in turns.
Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, 16> stresses(const AffineMap& map, const LocalVectors& row) {
  Eigen::Matrix<double, 4, Eigen::Dynamic, 0, 4, 16> stress(4, 2 * row.cols());
  for (int a = 0; a < row.cols(); ++a) {
    const Vector tau = map.jacobian * row.col(a) / map.determinant;
    stress.middleCols<2>(2 * a) << tau.x(), 0, 0, tau.y(), kHalf * tau.y(), kHalf * tau.x(), kHalf * tau.y(),
        -kHalf * tau.x();
  }
  return stress;
}

const SymmetricLaw& law_at(std::span<const SymmetricLaw> laws, int q) {
  return laws[laws.size() == 1 ? 0 : q];
}

}  // namespace

Eigen::Matrix3d piola(const AffineMap& map) {
  const double a = map.jacobian(0, 0), b = map.jacobian(0, 1), c = map.jacobian(1, 0), d = map.jacobian(1, 1);
  Eigen::Matrix3d transform;
  transform << a * a, b * b, 2 * a * b, c * c, d * d, 2 * c * d, a * c, b * d, a * d + b * c;
  transform.row(2) *= std::numbers::sqrt2;
  return transform / map.determinant;
}

JohnsonMercierRule::JohnsonMercierRule(const Spaces& spaces, int degree)
    : places(JohnsonMercier::places(rule_of_degree(degree))) {
  evaluate(spaces);
}

std::size_t JohnsonMercierRule::fill(const Spaces& spaces, std::span<const LawPiece> pieces, int of_fields,
                                     double tolerance) {
  constexpr std::size_t enough = 1500;
  places.clear();
  errors.clear();
  std::size_t taken = 0;
  while (taken < pieces.size() && places.size() < enough) {
    const LawPiece& piece = pieces[taken++];
    const int degree = piece.degree_of_rule(of_fields, tolerance);
    std::ranges::copy(JohnsonMercier::places(rule_of_degree(degree), piece.place.corners),
                      std::back_inserter(places));
    errors.resize(places.size(), piece.error_of_rule(degree, of_fields));
  }
  evaluate(spaces);
  return taken;
}

namespace {

/// Of both pairs of spaces, by their order.
template <int Degree>
const JohnsonMercierRule& johnson_mercier_rule_of_degree(int order) {
  static const std::array<JohnsonMercierRule, 2> rules{
      JohnsonMercierRule(spaces_of(Scheme::nonconforming, 2), Degree),
      JohnsonMercierRule(spaces_of(Scheme::conforming, 2), Degree)};
  return rules[order];
}

}  // namespace

const JohnsonMercierRule& johnson_mercier_rule(const Spaces& spaces, int degree) {
  if (degree <= 6) return johnson_mercier_rule_of_degree<6>(spaces.order);
  if (degree <= 10) return johnson_mercier_rule_of_degree<10>(spaces.order);
  return degree <= 18 ? johnson_mercier_rule_of_degree<18>(spaces.order)
                      : johnson_mercier_rule_of_degree<30>(spaces.order);
}

const InnerMass& inner_mass() {
  static const InnerMass mass = [] {
    InnerMass sum{decltype(sum.with_quadratic)::Zero(), decltype(sum.inner)::Zero()};
    for (const JohnsonMercier::Place& place : JohnsonMercier::places(rule_of_degree(6))) {
      const Eigen::Vector<double, kInner> inner = place.displacement_basis.tail<kInner>();
      sum.with_quadratic += place.weight * quadratic_basis(place.point) * inner.transpose();
      sum.inner += place.weight * inner * inner.transpose();
    }
    return sum;
  }();
  return mass;
}

void JohnsonMercierRule::evaluate(const Spaces& spaces) {
  const JohnsonMercier& element = johnson_mercier();
  values.resize(places.size());
  for (std::size_t q = 0; q < places.size(); ++q) {
    const JohnsonMercier::Place& place = places[q];
    Values& at = values[q];
    for (int k = 0; k < JohnsonMercier::kFree; ++k)
      at.free.col(k) = JohnsonMercier::stress(place, element.free.col(k));
    at.basis = quadratic_basis(place.point);
    at.gradients = quadratic_gradients(place.point);
    at.stress = spaces.row.reference_values(place.point);
  }
}

Eigen::Vector3d mandel(const Tensor<2>& tensor) {
  return {tensor[0], tensor[3], (tensor[1] + tensor[2]) * kHalf};
}

SymmetricLaw::SymmetricLaw(const Eigen::Matrix4d& c) {
  Eigen::Matrix<double, 4, 3> from;
  from << 1, 0, 0, 0, 0, kHalf, 0, 0, kHalf, 0, 1, 0;
  compliance = from.transpose() * c * from;
  stiffness = compliance.inverse();
  factor = compliance.llt().matrixL();
  const Eigen::Vector4d rotation(0, kHalf, -kHalf, 0);
  skew_compliance = rotation.dot(c * rotation);
}

std::vector<SymmetricLaw> laws_at(const Discretization& discrete, const JohnsonMercierRule& rule,
                                  const AffineMap& map, LawField<2>& law) {
  std::vector<SymmetricLaw> laws;
  const std::size_t count = discrete.element.has_constant_material() ? 1 : rule.places.size();
  for (std::size_t q = 0; q < count; ++q) laws.emplace_back(law(map(rule.places[q].point)).compliance);
  return laws;
}

template <int Columns>
JohnsonMercierStress<Columns>::JohnsonMercierStress(const AffineMap& map,
                                                    const Block<JohnsonMercier::kData>& data,
                                                    const Block<Eigen::Dynamic>& coefficients)
    : map_(map),
      to_triangle_(piola(map)),
      with_data_(johnson_mercier().from_data * data),
      coefficients_(coefficients),
      right_(Block<kFree>::Zero(kFree, data.cols())),
      free_(right_) {}

template <int Columns>
auto JohnsonMercierStress<Columns>::on(const JohnsonMercierRule& rule) const -> Values {
  const Eigen::Index columns = with_data_.cols();
  Values values;
  values.admissible.resize(rule.size(), Block<3>::Zero(3, columns));
  values.discrete = values.admissible;
  values.skew.resize(rule.size(), columns);
  for (int q = 0; q < rule.size(); ++q) {
    const auto of_stress = stresses(map_, rule.values[q].stress);
    values.discrete[q].noalias() = of_stress.template topRows<3>() * coefficients_;
    values.skew.row(q).noalias() = of_stress.row(3) * coefficients_;
    for (Eigen::Index k = 0; k < columns; ++k)
      values.admissible[q].col(k).noalias() =
          to_triangle_ * JohnsonMercier::stress(rule.places[q], with_data_.col(k));
  }
  update(rule, values);
  return values;
}

template <int Columns>
void JohnsonMercierStress<Columns>::update(const JohnsonMercierRule& rule, Values& values) const {
  if (!is_nearest_ || std::exchange(values.are_nearest, true)) return;
  for (int q = 0; q < rule.size(); ++q) values.admissible[q] += free_at(rule, q) * free_;
}

template <int Columns>
void JohnsonMercierStress<Columns>::add(const JohnsonMercierRule& rule, std::span<const SymmetricLaw> laws,
                                        const Values& values) {
  for (int q = 0; q < rule.size(); ++q) {
    const Eigen::Matrix<double, 3, kFree> own = free_at(rule, q);
    const Eigen::Matrix<double, kFree, 3> weighted =
        rule.places[q].weight * own.transpose() * law_at(laws, q).compliance;
    matrix_ += weighted * own;
    right_ += weighted * (values.discrete[q] - values.admissible[q]);
  }
}

template <int Columns>
void JohnsonMercierStress<Columns>::minimize() {
  free_ = solve_definite(matrix_, right_);
  is_nearest_ = true;
}

template <int Columns>
Eigen::Matrix<double, Eigen::Dynamic, Columns> correction(
    const JohnsonMercierRule& rule, const AffineMap& map,
    const typename JohnsonMercierStress<Columns>::Values& stress, std::span<const SymmetricLaw> laws) {
  Eigen::Matrix<double, Eigen::Dynamic, Columns> rows(3 * rule.size(), stress.skew.cols());
  for (int q = 0; q < rule.size(); ++q)
    rows.template middleRows<3>(3 * q) = std::sqrt(rule.places[q].weight * map.determinant) *
                                         law_at(laws, q).factor.transpose() *
                                         (stress.admissible[q] - stress.discrete[q]);
  return rows;
}

namespace {

/// Of the inner nodes, at a point of a rule.
Eigen::Matrix<double, 3, 2 * kInner> inner_strains(const AffineMap& map, const JohnsonMercier::Place& place) {
  const Eigen::Matrix2d to_gradients = map.jacobian.inverse().transpose();
  return strains<kInner>(to_gradients * place.displacement_gradients.rightCols<kInner>());
}

}  // namespace

template <int Columns>
JohnsonMercierFields<Columns>::JohnsonMercierFields(const AffineMap& map, const Given& given)
    : map_(map),
      stress_(map, given.data, given.stress),
      displacement_(given.displacement),
      right_(Block<2 * kInner>::Zero(2 * kInner, given.data.cols())),
      inner_(right_) {}

template <int Columns>
auto JohnsonMercierFields<Columns>::on(const JohnsonMercierRule& rule,
                                       std::span<const Eigen::Vector3d> lifted) const -> Values {
  const Eigen::Matrix2d to_gradients = map_.jacobian.inverse().transpose();
  Values values;
  values.stress = stress_.on(rule);
  values.strain.resize(rule.size(), Block<3>::Zero(3, displacement_.cols()));
  for (int q = 0; q < rule.size(); ++q) {
    values.strain[q].noalias() = strains<6>(to_gradients * rule.values[q].gradients) * displacement_;
    if (!lifted.empty()) values.strain[q].colwise() += lifted[q];
  }
  update(rule, values);
  return values;
}

template <int Columns>
void JohnsonMercierFields<Columns>::update(const JohnsonMercierRule& rule, Values& values) const {
  stress_.update(rule, values.stress);
  if (!has_inner_ || std::exchange(values.has_inner, true)) return;
  for (int q = 0; q < rule.size(); ++q) values.strain[q] += inner_strains(map_, rule.places[q]) * inner_;
}

template <int Columns>
void JohnsonMercierFields<Columns>::add(const JohnsonMercierRule& rule, std::span<const SymmetricLaw> laws,
                                        const Values& values) {
  stress_.add(rule, laws, values.stress);
  for (int q = 0; q < rule.size(); ++q) {
    const auto own = inner_strains(map_, rule.places[q]);
    const SymmetricLaw& law = law_at(laws, q);
    const Eigen::Matrix<double, 2 * kInner, 3> weighted =
        rule.places[q].weight * map_.determinant * own.transpose() * law.stiffness;
    matrix_ += weighted * own;
    right_ += weighted * (law.compliance * values.stress.admissible[q] - values.strain[q]);
    of_free_ += weighted * (law.compliance * stress_.free_at(rule, q));
  }
}

template <int Columns>
void JohnsonMercierFields<Columns>::minimize() {
  stress_.minimize();
  inner_ = solve_definite(matrix_, Block<2 * kInner>(right_ + of_free_ * stress_.free()));
  has_inner_ = true;
}

template <int Columns>
JohnsonMercierOperators<Columns>::JohnsonMercierOperators(
    const JohnsonMercierRule& rule, const AffineMap& map,
    const typename JohnsonMercierFields<Columns>::Values& values, std::span<const SymmetricLaw> laws) {
  const int points = rule.size();
  const Eigen::Index columns = values.stress.skew.cols();
  gap.resize(3 * points, columns);
  direct_gap.resize(3 * points, columns);
  strain.resize(3 * points, columns);
  correction = signorini::correction<Columns>(rule, map, values.stress, laws);
  skew.resize(points, columns);
  stress.resize(4 * points, columns);
  for (int q = 0; q < points; ++q) {
    const SymmetricLaw& own = law_at(laws, q);
    const double root = std::sqrt(rule.places[q].weight * map.determinant),
                 of_skew = root * std::sqrt(own.skew_compliance);
    const auto factor = own.factor.template triangularView<Eigen::Lower>();
    const Block<3>& all = values.strain[q];
    strain.template middleRows<3>(3 * q) = root * factor.solve(all);
    gap.template middleRows<3>(3 * q) =
        root * factor.solve(own.compliance * values.stress.admissible[q] - all);
    direct_gap.template middleRows<3>(3 * q) =
        root * factor.solve(own.compliance * values.stress.discrete[q] - all);
    stress.template middleRows<3>(4 * q) = root * own.factor.transpose() * values.stress.discrete[q];
    skew.row(q) = stress.row(4 * q + 3) = of_skew * values.stress.skew.row(q);
  }
}

template class JohnsonMercierStress<Eigen::Dynamic>;
template Eigen::MatrixXd correction<Eigen::Dynamic>(const JohnsonMercierRule&, const AffineMap&,
                                                    const JohnsonMercierStress<Eigen::Dynamic>::Values&,
                                                    std::span<const SymmetricLaw>);
template class JohnsonMercierFields<1>;
template class JohnsonMercierFields<Eigen::Dynamic>;
template struct JohnsonMercierOperators<1>;
template struct JohnsonMercierOperators<Eigen::Dynamic>;

JohnsonMercierNorms::JohnsonMercierNorms(const JohnsonMercierRule& rule, const AffineMap& map,
                                         const SymmetricLaw& law) {
  constexpr int data = JohnsonMercier::kData, displacement = 12;
  const Eigen::Index functions = 2 * rule.values.front().stress.cols();
  const Eigen::MatrixXd unit =
      Eigen::MatrixXd::Identity(data + functions + displacement, data + functions + displacement);
  JohnsonMercierFields<Eigen::Dynamic> fields(
      map, {unit.topRows<data>(), unit.middleRows(data, functions), unit.bottomRows<displacement>()});
  const std::span<const SymmetricLaw> laws(&law, 1);
  const JohnsonMercierOperators<Eigen::Dynamic> values(
      rule, map, minimized(fields, rule, laws, std::span<const Eigen::Vector3d>()), laws);
  gap = triangular_factor(values.gap);
  direct_gap = triangular_factor(values.direct_gap);
  strain = triangular_factor(values.strain);
  correction = triangular_factor(values.correction.leftCols(data + functions));
  skew = triangular_factor(values.skew.middleCols(data, functions));
  stress = triangular_factor(values.stress.middleCols(data, functions));
  inner = fields.inner();
}

}  // namespace signorini
