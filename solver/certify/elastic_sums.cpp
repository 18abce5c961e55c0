#include <cmath>

#include "certify/macro_data.hpp"
#include "certify/triangle_sums.hpp"

namespace signorini {
namespace {

/// What each part of a triangle with lifts is cut into along each side.
constexpr int kCuts = 4;

/// A shape that has come up so often is worth its operators.
constexpr int kOften = 100;

}  // namespace

ElasticSums::ElasticSums(const Discretization& problem, const Solution& solution,
                         const AdmissibleDisplacement& v, const EdgeTractions& tractions)
    : problem_(problem),
      solution_(solution),
      v_(v),
      tractions_(tractions),
      has_load_(problem.problem.body.size() > 0),
      plain_(problem.spaces(), 1),
      composite_(problem.spaces(), kCuts),
      shapes_(problem) {}

ElasticSums::Given ElasticSums::given_on(int t, const AffineMap& map, const LoadValues<2>& load) const {
  return {macro_data(tractions_, load, t, map), solution_.stress.col(t), v_.on<2>(t).reshaped(), {}};
}

/// The operators of the triangle's shape, or null.
const MacroNorms* ElasticSums::norms_of(int t, const AffineMap& map, LawField<2>& law) {
  Shape& shape = shapes_(t, [] { return Shape(); });
  if (++shape.seen == kOften)
    shape.norms = std::make_unique<const MacroNorms>(plain_, map, SymmetricLaw(law(map({0, 0})).compliance));
  return shape.norms.get();
}

/// The strains of what is lifted into the triangle.
std::vector<Eigen::Vector3d> ElasticSums::lifted_strains(int t, const AffineMap& map,
                                                         const MacroRule& rule) const {
  std::vector<Eigen::Vector3d> strains;
  for (const MacroElement::Place& place : rule.places) {
    Eigen::Vector2d value = Eigen::Vector2d::Zero();
    Tensor<2> slope = Tensor<2>::Zero();
    v_.add_lifts<2>(t, place.point, map.jacobian.inverse(), value, slope);
    strains.push_back(mandel(slope));
  }
  return strains;
}

/// (f, v), or what it is at least: f − Πf is orthogonal to v_h, where that is quadratic, and does no more
/// work on the inner part of v than the product of their norms.
double ElasticSums::work_of_load(int t, const AffineMap& map, const MacroRule& rule, const Given& given,
                                 const Inner& inner, const LoadValues<2>& load) const {
  if (!has_load_) return 0;
  const VectorField& f = problem_.problem.body;
  const auto [balanced, rest] = load.projection(t);
  double work = 0, inner_square = 0;
  for (int q = 0; q < rule.size(); ++q) {
    const MacroRule::Values& at = rule.values[q];
    const double weight = rule.places[q].weight * map.determinant;
    const Eigen::Vector2d of_inner = inner.reshaped(2, MacroRule::kInner) * at.inner_basis;
    Eigen::Vector2d v = given.displacement.reshaped(2, 6) * at.basis + of_inner, force = balanced * at.basis;
    if (!given.lifted.empty()) {
      Tensor<2> slope = Tensor<2>::Zero();
      v_.add_lifts<2>(t, rule.places[q].point, map.jacobian.inverse(), v, slope);
      const Point x = map(rule.places[q].point);
      force = {f(0, x), f(1, x)};
    }
    work += weight * force.dot(v);
    inner_square += weight * of_inner.squaredNorm();
  }
  return given.lifted.empty() ? work - rest * std::sqrt(inner_square) : work;
}

TriangleSums ElasticSums::operator()(int t, LawField<2>& law, const LoadValues<2>& load) {
  const AffineMap map(problem_.mesh.corners(t));
  Given given = given_on(t, map, load);
  const bool lifted = v_.is_lifted(t);
  const MacroNorms* norms = lifted ? nullptr : norms_of(t, map, law);
  if (norms) {
    constexpr int most = MacroElement::kData + kMaxLocal + 12;
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> z(norms->gap.cols());
    z << given.data, given.stress, given.displacement;
    const auto square = [](const Eigen::MatrixXd& factor, const auto& part) {
      return (factor.triangularView<Eigen::Upper>() * part).squaredNorm();
    };
    const auto stresses = z.head(norms->correction.cols());
    return {square(norms->gap, z),
            square(norms->direct_gap, z),
            square(norms->correction, stresses),
            square(norms->skew, given.stress),
            square(norms->stress, given.stress),
            square(norms->strain, z) / 2 - work_of_load(t, map, plain_, given, norms->inner * z, load)};
  }
  const MacroRule& rule = lifted ? composite_ : plain_;
  if (lifted) given.lifted = lifted_strains(t, map, rule);
  const MacroValues<1> values(rule, map, given, laws_at(problem_, rule, map, law));
  return {values.gap.squaredNorm(),
          values.direct_gap.squaredNorm(),
          values.correction.squaredNorm(),
          values.skew.squaredNorm(),
          values.stress.squaredNorm(),
          values.strain.squaredNorm() / 2 - work_of_load(t, map, rule, given, values.inner, load)};
}

}  // namespace signorini
