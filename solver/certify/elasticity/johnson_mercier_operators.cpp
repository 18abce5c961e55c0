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

void JohnsonMercierRule::fill(const Spaces& spaces, const std::vector<LawPiece>& pieces, int of_fields,
                              double tolerance) {
  const auto places_of = [&](const LawPiece& piece) {
    const int degree = piece.degree_of_rule(of_fields, tolerance);
    return JohnsonMercier::places(rule_of_degree(degree), piece.place.corners);
  };
  // They may be tens of megabytes, of which a growing vector would have three times as many.
  std::size_t points = 0;
  for (const LawPiece& piece : pieces) points += places_of(piece).size();
  if (points > places.capacity()) *this = JohnsonMercierRule();
  places.clear();
  places.reserve(points);
  errors.clear();
  for (const LawPiece& piece : pieces) {
    std::ranges::copy(places_of(piece), std::back_inserter(places));
    errors.resize(places.size(), piece.error_of_rule(piece.degree_of_rule(of_fields, tolerance), of_fields));
  }
  evaluate(spaces);
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
JohnsonMercierStress<Columns>::JohnsonMercierStress(const JohnsonMercierRule& rule, const AffineMap& map,
                                                    const Block<JohnsonMercier::kData>& data,
                                                    const Block<Eigen::Dynamic>& coefficients,
                                                    std::span<const SymmetricLaw> laws)
    : admissible(rule.size(), Block<3>::Zero(3, data.cols())),
      discrete(admissible),
      skew(rule.size(), data.cols()) {
  const Eigen::Matrix3d to_triangle = piola(map);
  const Block<JohnsonMercier::kStresses> with_data = johnson_mercier().from_data * data;
  constexpr int kFree = JohnsonMercier::kFree;
  Eigen::Matrix<double, kFree, kFree> free_matrix = decltype(free_matrix)::Zero();
  Block<kFree> free_right = Block<kFree>::Zero(kFree, data.cols());
  for (int q = 0; q < rule.size(); ++q) {
    const JohnsonMercierRule::Values& at = rule.values[q];
    const auto of_stress = stresses(map, at.stress);
    discrete[q].noalias() = of_stress.template topRows<3>() * coefficients;
    skew.row(q).noalias() = of_stress.row(3) * coefficients;
    for (Eigen::Index k = 0; k < data.cols(); ++k)
      admissible[q].col(k).noalias() = to_triangle * JohnsonMercier::stress(rule.places[q], with_data.col(k));
    const Eigen::Matrix<double, 3, kFree> own = to_triangle * at.free;
    const Eigen::Matrix<double, kFree, 3> weighted =
        rule.places[q].weight * own.transpose() * law_at(laws, q).compliance;
    free_matrix += weighted * own;
    free_right += weighted * (discrete[q] - admissible[q]);
  }
  const Block<kFree> free = solve_definite(free_matrix, free_right);
  for (int q = 0; q < rule.size(); ++q) admissible[q] += (to_triangle * rule.values[q].free).eval() * free;
}

template <int Columns>
Eigen::Matrix<double, Eigen::Dynamic, Columns> correction(const JohnsonMercierRule& rule,
                                                          const AffineMap& map,
                                                          const JohnsonMercierStress<Columns>& stress,
                                                          std::span<const SymmetricLaw> laws) {
  Eigen::Matrix<double, Eigen::Dynamic, Columns> rows(3 * rule.size(), stress.skew.cols());
  for (int q = 0; q < rule.size(); ++q)
    rows.template middleRows<3>(3 * q) = std::sqrt(rule.places[q].weight * map.determinant) *
                                         law_at(laws, q).factor.transpose() *
                                         (stress.admissible[q] - stress.discrete[q]);
  return rows;
}

template <int Columns>
JohnsonMercierOperators<Columns>::JohnsonMercierOperators(const JohnsonMercierRule& rule,
                                                          const AffineMap& map, const Given& given,
                                                          std::span<const SymmetricLaw> laws) {
  const int points = rule.size();
  const Eigen::Index columns = given.data.cols();
  const Eigen::Matrix2d to_gradients = map.jacobian.inverse().transpose();
  const auto weight = [&](int q) { return rule.places[q].weight * map.determinant; };
  const JohnsonMercierStress<Columns> sigma(rule, map, given.data, given.stress, laws);

  // v is v_h and what brings its strain nearest to C σ*.
  std::vector<Block<3>> strains_of_v(points, Block<3>::Zero(3, columns));
  Eigen::Matrix<double, 2 * kInner, 2 * kInner> inner_matrix = decltype(inner_matrix)::Zero();
  Block<2 * kInner> inner_right = Block<2 * kInner>::Zero(2 * kInner, columns);
  for (int q = 0; q < points; ++q) {
    const JohnsonMercierRule::Values& at = rule.values[q];
    strains_of_v[q].noalias() = strains<6>(to_gradients * at.gradients) * given.displacement;
    if (!given.lifted.empty()) strains_of_v[q].colwise() += given.lifted[q];
    const auto own =
        strains<kInner>(to_gradients * rule.places[q].displacement_gradients.rightCols<kInner>());
    const SymmetricLaw& law = law_at(laws, q);
    const Eigen::Matrix<double, 2 * kInner, 3> weighted = weight(q) * own.transpose() * law.stiffness;
    inner_matrix += weighted * own;
    inner_right += weighted * (law.compliance * sigma.admissible[q] - strains_of_v[q]);
  }
  inner = solve_definite(inner_matrix, inner_right);

  gap.resize(3 * points, columns);
  direct_gap.resize(3 * points, columns);
  strain.resize(3 * points, columns);
  correction = signorini::correction(rule, map, sigma, laws);
  skew.resize(points, columns);
  stress.resize(4 * points, columns);
  for (int q = 0; q < points; ++q) {
    const SymmetricLaw& own = law_at(laws, q);
    const double root = std::sqrt(weight(q)), of_skew = root * std::sqrt(own.skew_compliance);
    const auto factor = own.factor.template triangularView<Eigen::Lower>();
    const Block<3> all =
        strains_of_v[q] +
        strains<kInner>(to_gradients * rule.places[q].displacement_gradients.rightCols<kInner>()) * inner;
    strain.template middleRows<3>(3 * q) = root * factor.solve(all);
    gap.template middleRows<3>(3 * q) = root * factor.solve(own.compliance * sigma.admissible[q] - all);
    direct_gap.template middleRows<3>(3 * q) = root * factor.solve(own.compliance * sigma.discrete[q] - all);
    stress.template middleRows<3>(4 * q) = root * own.factor.transpose() * sigma.discrete[q];
    skew.row(q) = stress.row(4 * q + 3) = of_skew * sigma.skew.row(q);
  }
}

template struct JohnsonMercierStress<Eigen::Dynamic>;
template Eigen::MatrixXd correction(const JohnsonMercierRule&, const AffineMap&,
                                    const JohnsonMercierStress<Eigen::Dynamic>&,
                                    std::span<const SymmetricLaw>);
template struct JohnsonMercierOperators<1>;
template struct JohnsonMercierOperators<Eigen::Dynamic>;

JohnsonMercierNorms::JohnsonMercierNorms(const JohnsonMercierRule& rule, const AffineMap& map,
                                         const SymmetricLaw& law) {
  constexpr int data = JohnsonMercier::kData, displacement = 12;
  const Eigen::Index functions = 2 * rule.values.front().stress.cols();
  const Eigen::MatrixXd unit =
      Eigen::MatrixXd::Identity(data + functions + displacement, data + functions + displacement);
  const JohnsonMercierOperators<Eigen::Dynamic> values(
      rule, map,
      {unit.topRows<data>(), unit.middleRows(data, functions), unit.bottomRows<displacement>(), {}},
      std::span(&law, 1));
  gap = triangular_factor(values.gap);
  direct_gap = triangular_factor(values.direct_gap);
  strain = triangular_factor(values.strain);
  correction = triangular_factor(values.correction.leftCols(data + functions));
  skew = triangular_factor(values.skew.middleCols(data, functions));
  stress = triangular_factor(values.stress.middleCols(data, functions));
  inner = values.inner;
}

}  // namespace signorini
