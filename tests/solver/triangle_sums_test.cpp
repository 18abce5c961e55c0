// What one triangle adds to the bound, and what that may be off by, against integrals of the fields with all
// that the sums leave out.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "certificate_fields.hpp"
#include "certify/elasticity/johnson_mercier_data.hpp"
#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "certify/membrane/quadratic_balance.hpp"
#include "certify/triangle_sums.hpp"
#include "fem/cubature.hpp"
#include "problems/elasticity.hpp"
#include "run/requested_mesh.hpp"
#include "solved_problem.hpp"

namespace signorini::triangle_sums_test {
namespace {

/// The part z of v that the sums do not see: what u_D is beyond the lift on a fixed edge of the triangle,
/// ρ d(λ_b / ρ) of THEORY.md, section 6.
class RestOfLift {
 public:
  /// `value`: u_D by s ∈ [0, 1] along the edge.
  RestOfLift(const Mesh& mesh, const AdmissibleDisplacement& v, int edge,
             std::function<Eigen::VectorXd(const Point&)> value)
      : v_(v), edge_(edge), value_(std::move(value)) {
    const int t = mesh.edge_triangles[edge][0], e = mesh.local_edge(t, edge);
    const auto& [a, b] = mesh.edges[edge];
    ends_ = {mesh.points[a], mesh.points[b]};
    one_ = mesh.triangles[t][(e + 1) % 3] == a ? (e + 1) % 3 : (e + 2) % 3;
    other_ = 3 - e - one_;
    const Eigen::Matrix2d inverse = AffineMap(mesh.corners(t)).jacobian.inverse();
    hats_ << -inverse.row(0) - inverse.row(1), inverse.row(0), inverse.row(1);
  }

  Eigen::VectorXd value(const Point& reference) const {
    const auto [rho, s] = place(reference);
    return rho * d(s);
  }

  /// Row c of component c.
  Eigen::Matrix<double, Eigen::Dynamic, 2> gradient(const Point& reference) const {
    const auto [rho, s] = place(reference);
    constexpr double step = 1e-5;
    const double low = std::max(0., s - step), high = std::min(1., s + step);
    const Eigen::VectorXd slope = (d(high) - d(low)) / (high - low);
    const Eigen::RowVector2d of_rho = hats_.row(one_) + hats_.row(other_);
    return d(s) * of_rho + slope * (hats_.row(other_) - s * of_rho);
  }

 private:
  std::pair<double, double> place(const Point& x) const {
    const Eigen::Vector3d lambda(1 - x.x() - x.y(), x.x(), x.y());
    const double rho = lambda[one_] + lambda[other_];
    return {rho, rho > 0 ? lambda[other_] / rho : 0};
  }
  Eigen::VectorXd d(double s) const {
    return value_(ends_[0] + s * (ends_[1] - ends_[0])) - v_.on_edge(edge_, s);
  }

  const AdmissibleDisplacement& v_;
  int edge_, one_, other_;
  std::function<Eigen::VectorXd(const Point&)> value_;
  std::array<Point, 2> ends_;
  Eigen::Matrix<double, 3, 2> hats_;
};

/// An anisotropic membrane with one fixed side, and all else that adds to the sums: its load and its traction
/// are beyond what the schemes balance, its gap bends.
Problem membrane(Scheme scheme, const std::string& fixed, const std::string& load) {
  Problem problem;
  problem.scheme = scheme;
  problem.mesh = {Divisions{2, 2}, Pattern::right};
  problem.material = MembraneStiffness{Field(2), Field(0.3), Field(0.7)};
  problem.body = problems::formula(load);
  problem.boundary = {{"left", Fixed{problems::formula(fixed)}},
                      {"bottom", Contact{problems::formula("0.02 + 0.03*x^2")}},
                      {"top", Traction{problems::formula("x^2 - 0.4")}}};
  return problem;
}

/// The larger eigenvalue of its stiffness.
const double kStiffest = 1.35 + std::hypot(0.65, 0.3);

/// The sums of a triangle with a rule so fine that it is exact, of the fields as they are.
struct Fields {
  CertificateFields& made;
  int t;
  const RestOfLift* rest = nullptr;

  AffineMap map() const { return AffineMap(made.mesh().corners(t)); }
  Vector sigma(const Point& x) const {
    Vector sigma = made.admissible_stress(t, x);
    const std::optional<QuadraticBalance::Data> balance = QuadraticBalance(made.discretization())(t);
    if (balance)
      sigma += map().jacobian * (QuadraticBalance::reference_values(x) * *balance) / map().determinant;
    return sigma;
  }
  Vector slope(const Point& x) const {
    Vector slope = made.slope(t, x);
    if (rest) slope += rest->gradient(x).transpose();
    return slope;
  }
  double value(const Point& x) const {
    Eigen::Matrix<double, 1, 1> value = made.pair().v.on<1>(t) * quadratic_basis(x);
    Tensor<1> slope = Tensor<1>::Zero();
    made.pair().v.add_lifts<1>(t, x, map().jacobian.inverse(), value, slope);
    return value[0] + (rest ? rest->value(x)[0] : 0);
  }
  TriangleSums sums(const std::function<double(const Point&)>& load) const {
    const Eigen::Matrix2d stiffness{{2, 0.3}, {0.3, 0.7}}, compliance = stiffness.inverse();
    const auto integral = [&](const auto& f) {
      return map().determinant * integrate_from(made.corner_to_integrate_from(t), f);
    };
    const auto square_of_gap = [&](const Vector& stress, const Vector& slope) {
      const Vector gap = compliance * stress - slope;
      return gap.dot(stiffness * gap);
    };
    TriangleSums sums;
    sums.gap = integral([&](const Point& x) { return square_of_gap(sigma(x), slope(x)); });
    sums.direct_gap = integral([&](const Point& x) { return square_of_gap(made.stress(t, x), slope(x)); });
    sums.correction = integral([&](const Point& x) {
      const Vector delta = sigma(x) - made.stress(t, x);
      return delta.dot(compliance * delta);
    });
    sums.stress =
        integral([&](const Point& x) { return made.stress(t, x).dot(compliance * made.stress(t, x)); });
    sums.strain = integral([&](const Point& x) { return slope(x).dot(stiffness * slope(x)) / 2; });
    sums.energy = sums.strain - integral([&](const Point& x) { return load(map()(x)) * value(x); });
    return sums;
  }
};

constexpr std::array kSums{&TriangleSums::gap, &TriangleSums::direct_gap, &TriangleSums::correction,
                           &TriangleSums::stress, &TriangleSums::strain};

TriangleSums sums_by_the_code(CertificateFields& made, const Problem& problem, int t) {
  LawField<1> law(problem.material);
  const LawOnMesh laws(problem.material, made.mesh(), 1e-8, made.progress());
  ShapeNorms norms;
  return MembraneSums(made.discretization(), made.solution().stress, made.pair(), norms)(t, law, laws);
}

constexpr std::array kSchemes{Scheme::conforming, Scheme::nonconforming};

std::shared_ptr<const Mesh> mesh_of(const Problem& problem) {
  Observer observer;
  Progress progress(observer, std::nullopt);
  return requested_mesh(problem, progress);
}

/// A polynomial on the fixed side is lifted exactly, and nothing is left out: neither by points nor by the
/// norms of a shape that sixty triangles have.
void expect_sums_of_the_fields(int divisions) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = membrane(scheme, "0.3*y^3 - 0.1*y", "-6 + 20*x*y - 9*y^2");
    problem.mesh.fineness = Divisions{divisions, divisions};
    CertificateFields made(problem, mesh_of(problem));
    const auto load = [](const Point& x) { return -6 + 20 * x.x() * x.y() - 9 * x.y() * x.y(); };
    bool is_corrected = false, is_curled = false;
    for (int t = 0; t < made.discretization().triangles(); ++t) {
      const TriangleSums said = sums_by_the_code(made, problem, t), seen = Fields{made, t}.sums(load);
      for (const auto sum : kSums) EXPECT_NEAR(said.*sum, seen.*sum, 1e-9 * (seen.stress + seen.strain)) << t;
      EXPECT_NEAR(said.energy, seen.energy, 1e-9 * seen.strain);
      EXPECT_LE(said.slack + said.energy_slack, 1e-9 * seen.stress);
      is_corrected |= seen.correction > 1e-3 * seen.stress;
      is_curled |= !made.pair().stream_function_on(made.mesh(), t).isZero(0);
    }
    EXPECT_TRUE(is_corrected && is_curled);
  }
}

TEST(MembraneSums, AreThoseOfTheFields) {
  expect_sums_of_the_fields(2);
}

TEST(MembraneSums, AreThoseOfTheFieldsWhereShapesAreMany) {
  expect_sums_of_the_fields(8);
}

/// max |z| and max |∇z| on the triangle, its boundary but for the corner across.
std::pair<double, double> largest(const RestOfLift& rest) {
  double value = 0, slope = 0;
  constexpr int n = 100;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Point x(static_cast<double>(i) / n, static_cast<double>(j) / n);
      value = std::max(value, rest.value(x).norm());
      slope = std::max(slope, rest.gradient(x).norm());
    }
  return {value, slope};
}

/// The bounds of a rest hold, and what the energy may be off by has both of its terms.
void expect_bounded(const AdmissibleDisplacement::LiftRest& said, const RestOfLift& rest, double zeta,
                    const TriangleSums& sums, double force) {
  const auto [value, slope] = largest(rest);
  EXPECT_GE(said.value, value);
  EXPECT_GE(said.slope, slope);
  const double of_strain = zeta * (std::sqrt(2 * sums.strain) + zeta / 2);
  EXPECT_GE(sums.energy_slack, of_strain + value * force);
}

/// Of a wave on the fixed side a lift has the most; the rest is a function of which only a bound is known.
TEST(MembraneSums, AreOffByNoMoreThanTheRestOfALift) {
  for (const Scheme scheme : kSchemes) {
    const Problem problem = membrane(scheme, "0.3*sin(19*y)", "-6 + 20*x*y");
    CertificateFields made(problem, mesh_of(problem));
    const auto load = [](const Point& x) { return -6 + 20 * x.x() * x.y(); };
    const auto fixed = [](const Point& x) {
      return Eigen::VectorXd::Constant(1, 0.3 * std::sin(19 * x.y()));
    };
    int lifted = 0;
    for (const BoundaryPart& part : made.mesh().boundary)
      for (const int edge : part.edges) {
        if (part.name != "left") continue;
        const int t = made.mesh().edge_triangles[edge][0];
        const RestOfLift rest(made.mesh(), made.pair().v, edge, fixed);
        const TriangleSums said = sums_by_the_code(made, problem, t),
                           seen = Fields{made, t, &rest}.sums(load);
        for (const auto sum : {&TriangleSums::gap, &TriangleSums::direct_gap, &TriangleSums::strain}) {
          EXPECT_LE(std::abs(said.*sum - seen.*sum), said.slack);
          EXPECT_GT(std::abs(said.*sum - seen.*sum), 1e-9 * seen.strain);
        }
        EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack);
        EXPECT_GT(std::abs(said.energy - seen.energy), 1e-9 * seen.strain);
        const AdmissibleDisplacement::LiftRest bound = made.pair().v.rest_of_lifts(t);
        const AffineMap map(made.mesh().corners(t));
        const double zeta = bound.slope * std::sqrt(map.determinant / 2 * kStiffest),
                     force = map.determinant *
                             integrate_from(0, [&](const Point&x) { return std::abs(load(map(x))); });
        expect_bounded(bound, rest, zeta, said, force);
        ++lifted;
      }
    EXPECT_EQ(lifted, 2);
  }
}

/// The ninth derivative of s⁹ is the same everywhere, so that the bounds of what a lift leaves are sharp.
TEST(MembraneSums, KnowTheRestOfALiftCloselyWhereItsDerivativeIsConstant) {
  const Problem problem = membrane(Scheme::conforming, "y*y*y*y*y*y*y*y*y", "-6");
  CertificateFields made(problem, mesh_of(problem));
  const auto fixed = [](const Point& x) { return Eigen::VectorXd::Constant(1, std::pow(x.y(), 9)); };
  for (const BoundaryPart& part : made.mesh().boundary)
    for (const int edge : part.edges) {
      if (part.name != "left") continue;
      const int t = made.mesh().edge_triangles[edge][0];
      const RestOfLift rest(made.mesh(), made.pair().v, edge, fixed);
      const auto [value, slope] = largest(rest);
      const AdmissibleDisplacement::LiftRest said = made.pair().v.rest_of_lifts(t);
      EXPECT_GE(said.value, value);
      EXPECT_LE(said.value, 1.1 * value);
      EXPECT_GE(said.slope, slope);
      EXPECT_LE(said.slope, 2 * slope);
    }
}

/// f − Πf is orthogonal to what is quadratic, and not to a lift.
TEST(MembraneSums, AreOffByNoMoreThanALoadDoesOnALift) {
  for (const Scheme scheme : kSchemes) {
    const Problem problem = membrane(scheme, "0.3*(y^3 - y^2)", "-6 + 900*(y - 0.2)^3");
    CertificateFields made(problem, mesh_of(problem));
    const auto load = [](const Point& x) { return -6 + 900 * std::pow(x.y() - 0.2, 3); };
    double most = 0;
    for (int t = 0; t < made.discretization().triangles(); ++t) {
      const TriangleSums said = sums_by_the_code(made, problem, t), seen = Fields{made, t}.sums(load);
      EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack + 1e-10 * seen.strain);
      most = std::max(most, std::abs(said.energy - seen.energy) / seen.strain);
    }
    EXPECT_GT(most, 1e-7);
  }
}

/// Strains of a known norm, in any direction, and fields of any sizes.
TEST(TriangleSums, AreOffByNoMoreThanAnUnknownStrainMakes) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  using Field = Eigen::Vector4d;
  const auto field = [&] {
    const double size = std::pow(10, 2 * normal(random));
    return Field(size * Field::NullaryExpr([&] { return normal(random); }));
  };
  const auto sums_of = [](const Field& gap, const Field& delta, const Field& w, const Field& tau) {
    TriangleSums sums;
    sums.gap = gap.squaredNorm();
    sums.direct_gap = (gap - delta).squaredNorm();
    sums.correction = delta.squaredNorm();
    sums.span = (w + tau).squaredNorm();
    sums.along = (w + tau).dot(delta);
    sums.known = gap.dot(w - tau);
    sums.moved = w.squaredNorm();
    return sums;
  };
  for (int run = 0; run < 1000; ++run) {
    const Field gap = field(), delta = field(), w = field(), tau = field();
    const double zeta = std::pow(10, 2 * normal(random));
    TriangleSums said = sums_of(gap, delta, w, tau);
    said.add_unknown_strain(zeta);
    for (const Field& along : {gap, Field(gap - delta), delta, Field(w + tau), Field(w - tau), w, field()})
      for (const double sign : {-1., 1.}) {
        // v + z in place of v, in v and in w = v − v₂.
        const Field z = sign * zeta * along.normalized();
        const TriangleSums seen = sums_of(gap - z, delta, w + z, tau);
        for (const auto sum :
             {&TriangleSums::gap, &TriangleSums::direct_gap, &TriangleSums::correction, &TriangleSums::span,
              &TriangleSums::along, &TriangleSums::known, &TriangleSums::moved})
          EXPECT_LE(std::abs(seen.*sum - said.*sum), said.slack * (1 + 1e-12));
      }
  }
}

/// The integrals over a triangle by rules that look at the law coarsely, against those that look closely.
TEST(TriangleSums, AreOffByNoMoreThanTheirSlack) {
  Problem problem = problems::paper(Scheme::conforming, 3);
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.5*sin(9*x)"));
  CertificateFields fields(problem, mesh_of(problem));
  ShapeNorms norms;
  const MembraneSums sums(fields.discretization(), fields.solution().stress, fields.pair(), norms);
  LawField<1> law(problem.material);
  const LawOnMesh coarse(problem.material, fields.mesh(), 0.3, fields.progress()),
      close(problem.material, fields.mesh(), 1e-10, fields.progress());
  double largest = 0, largest_of_energies = 0;
  for (int t = 0; t < fields.discretization().triangles(); ++t) {
    const TriangleSums seen = sums(t, law, coarse), exact = sums(t, law, close);
    for (const auto sum : kSums) {
      EXPECT_LE(std::abs(seen.*sum - exact.*sum), seen.slack + exact.slack);
      largest = std::max(largest, std::abs(seen.*sum - exact.*sum) / seen.stress);
    }
    EXPECT_LE(std::abs(seen.energy - exact.energy), seen.energy_slack + exact.energy_slack);
    largest_of_energies = std::max(largest_of_energies, std::abs(seen.energy - exact.energy) / seen.stress);
  }
  EXPECT_GT(largest, 1e-7);  // there is something that the slack has to pay for
  EXPECT_GT(largest_of_energies, 1e-8);
}

/// An elastic block with a fixed left side.
Problem block(Scheme scheme, const std::string& fixed, const std::string& load, const Material& material) {
  Problem problem;
  problem.scheme = scheme;
  problem.mesh = {Divisions{2, 2}, Pattern::right};
  problem.material = material;
  problem.body = VectorField(problems::formula(load), Field(-0.3));
  problem.boundary = {{"left", Fixed{VectorField(Field(0), problems::formula(fixed))}},
                      {"bottom", Contact{problems::formula("0.02 + 0.03*x^2")}}};
  return problem;
}

const Material steel = YoungPoisson{Field(2), Field(0.3), Plane::strain};

/// What ElasticSums integrates, by points of a rule of degree 30 on each part of the macro-element.
class ElasticFields {
 public:
  explicit ElasticFields(const Problem& problem)
      : made_(problem, solve(problem, {ActiveSet{}, {}})),
        v_(made_.displacement()),
        tractions_(made_.discretization, made_.solution.stress,
                   {made_.discretization, made_.solution.stress, made_.clearance}, made_.progress) {}

  const Mesh& mesh() const { return *made_.solution.mesh; }
  const AdmissibleDisplacement& v() const { return v_; }
  int triangles() const { return made_.discretization.triangles(); }
  const Discretization& discretization() const { return made_.discretization; }

  TriangleSums said(int t, double tolerance) const {
    LawField<2> law(made_.problem.material);
    const LawOnMesh laws(made_.problem.material, mesh(), tolerance, made_.progress);
    ShapeNorms norms;
    return ElasticSums(made_.discretization, made_.solution, v_, tractions_, norms)(t, law, laws);
  }

  std::vector<TriangleSums> said_of_all(double tolerance) const {
    LawField<2> law(made_.problem.material);
    const LawOnMesh laws(made_.problem.material, mesh(), tolerance, made_.progress);
    ShapeNorms norms;
    ElasticSums sums(made_.discretization, made_.solution, v_, tractions_, norms);
    std::vector<TriangleSums> all;
    for (int t = 0; t < triangles(); ++t) all.push_back(sums(t, law, laws));
    return all;
  }

  TriangleSums seen(int t, const std::function<double(const Point&)>& load,
                    const RestOfLift* rest = nullptr) const {
    const JohnsonMercierRule& rule = johnson_mercier_rule(made_.discretization.spaces(), 30);
    const AffineMap map(mesh().corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    JohnsonMercierFields<1> on_element(map, {johnson_mercier_data(made_.discretization, tractions_, t, map),
                                             made_.solution.stress.col(t), v_.on<2>(t).reshaped()});
    std::vector<Eigen::Vector3d> lifted;
    std::vector<Eigen::Vector2d> values;
    for (int q = 0; q < rule.size(); ++q) {
      const Point& x = rule.places[q].point;
      Eigen::Vector2d value = v_.on<2>(t) * quadratic_basis(x);
      Tensor<2> slope = Tensor<2>::Zero();
      v_.add_lifts<2>(t, x, inverse, value, slope);
      lifted.push_back(mandel(slope));
      values.push_back(value);
    }
    LawField<2> law(made_.problem.material);
    const std::vector<SymmetricLaw> laws = laws_at(made_.discretization, rule, map, law);
    const JohnsonMercierOperators<1> fields(rule, map, minimized(on_element, rule, laws, lifted), laws);
    TriangleSums sums;
    for (int q = 0; q < rule.size(); ++q) {
      const JohnsonMercier::Place& place = rule.places[q];
      const double weight = place.weight * map.determinant;
      const auto& own = laws[laws.size() == 1 ? 0 : q];
      // In the norm of E, as the rows of the fields are.
      Eigen::Vector3d z = Eigen::Vector3d::Zero();
      Eigen::Vector2d value = values[q] + on_element.inner().reshaped(2, JohnsonMercierRule::kInner) *
                                              place.displacement_basis.tail<JohnsonMercierRule::kInner>();
      if (rest) {
        const Eigen::Matrix<double, Eigen::Dynamic, 2> slope = rest->gradient(place.point);
        value += rest->value(place.point);
        z = std::sqrt(weight) * own.factor.triangularView<Eigen::Lower>().solve(Eigen::Vector3d(
                                    slope(0, 0), slope(1, 1), std::sqrt(0.5) * (slope(0, 1) + slope(1, 0))));
      }
      const auto at = [q](const auto& rows) { return Eigen::Vector3d(rows.template middleRows<3>(3 * q)); };
      sums.gap += (at(fields.gap) - z).squaredNorm();
      sums.direct_gap += (at(fields.direct_gap) - z).squaredNorm();
      sums.correction += at(fields.correction).squaredNorm();
      sums.strain += (at(fields.strain) + z).squaredNorm() / 2;
      sums.energy -= weight * (load(map(place.point)) * value[0] - 0.3 * value[1]);
      sums.stress += fields.stress.middleRows<4>(4 * q).squaredNorm();
      sums.skew += std::pow(fields.stress(4 * q + 3), 2);
    }
    sums.energy += sums.strain;
    return sums;
  }

 private:
  SolvedProblem made_;
  AdmissibleDisplacement v_;
  EdgeTractions tractions_;
};

TEST(ElasticSums, AreThoseOfTheFields) {
  for (const Scheme scheme : kSchemes) {
    const ElasticFields fields(block(scheme, "0.3*y^3 - 0.1*y", "-6 + 20*x*y - 9*y^2", steel));
    const auto load = [](const Point& x) { return -6 + 20 * x.x() * x.y() - 9 * x.y() * x.y(); };
    for (int t = 0; t < fields.triangles(); ++t) {
      const TriangleSums said = fields.said(t, 1e-8), seen = fields.seen(t, load);
      for (const auto sum : kSums) EXPECT_NEAR(said.*sum, seen.*sum, 1e-9 * (seen.stress + seen.strain)) << t;
      EXPECT_NEAR(said.skew, seen.skew, 1e-9 * seen.stress);
      EXPECT_GT(seen.skew, 1e-6 * seen.stress);
      EXPECT_NEAR(said.energy, seen.energy, 1e-9 * seen.strain);
      EXPECT_LE(said.slack + said.energy_slack, 1e-9 * seen.stress);
    }
  }
}

/// Of a shape that comes up often the sums are squares of norms.
TEST(ElasticSums, OfShapesThatComeUpOftenAreThoseOfTheFields) {
  for (const Scheme scheme : kSchemes) {
    Problem problem = block(scheme, "0", "-6 + 20*x*y", steel);
    problem.mesh = {Divisions{11, 11}, Pattern::right};
    const ElasticFields fields(problem);
    const std::vector<TriangleSums> said = fields.said_of_all(1e-8);
    const auto load = [](const Point& x) { return -6 + 20 * x.x() * x.y(); };
    for (const int t : {fields.triangles() - 2, fields.triangles() - 1}) {
      const TriangleSums seen = fields.seen(t, load);
      for (const auto sum : kSums)
        EXPECT_NEAR(said[t].*sum, seen.*sum, 1e-9 * (seen.stress + seen.strain)) << t;
      EXPECT_NEAR(said[t].skew, seen.skew, 1e-9 * seen.stress);
    }
  }
}

TEST(ElasticSums, AreOffByNoMoreThanTheRestOfALift) {
  for (const Scheme scheme : kSchemes) {
    const ElasticFields fields(block(scheme, "0.3*sin(19*y)", "-6 + 20*x*y", steel));
    const auto load = [](const Point& x) { return -6 + 20 * x.x() * x.y(); };
    const auto fixed = [](const Point& x) -> Eigen::VectorXd {
      return Vector(0, 0.3 * std::sin(19 * x.y()));
    };
    int lifted = 0;
    for (const BoundaryPart& part : fields.mesh().boundary)
      for (const int edge : part.edges) {
        if (part.name != "left") continue;
        const int t = fields.mesh().edge_triangles[edge][0];
        const RestOfLift rest(fields.mesh(), fields.v(), edge, fixed);
        const TriangleSums said = fields.said(t, 1e-8), seen = fields.seen(t, load, &rest);
        for (const auto sum : {&TriangleSums::gap, &TriangleSums::direct_gap, &TriangleSums::strain}) {
          EXPECT_LE(std::abs(said.*sum - seen.*sum), said.slack);
          EXPECT_GT(std::abs(said.*sum - seen.*sum), 1e-9 * seen.strain);
        }
        EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack);
        EXPECT_GT(std::abs(said.energy - seen.energy), 1e-9 * seen.strain);
        const AdmissibleDisplacement::LiftRest bound = fields.v().rest_of_lifts(t);
        const AffineMap map(fields.mesh().corners(t));
        constexpr double stiffest = 2 / 1.3 / 0.4;  // E / ((1 + ν) (1 − 2 ν))
        const double zeta = bound.slope * std::sqrt(map.determinant / 2 * stiffest),
                     force = map.determinant *
                             integrate_from(0, [&](const Point&x) { return std::hypot(load(map(x)), 0.3); });
        expect_bounded(bound, rest, zeta, said, force);
        ++lifted;
      }
    EXPECT_EQ(lifted, 2);
  }
}

/// f − Πf is orthogonal to what is quadratic, and not to a lift or to what v has inside the macro-element.
TEST(ElasticSums, AreOffByNoMoreThanALoadDoesBeyondWhatIsQuadratic) {
  for (const Scheme scheme : kSchemes)
    for (const std::string fixed : {"0", "0.3*(y^3 - y^2)"}) {
      const ElasticFields fields(block(scheme, fixed, "-6 + 900*(y - 0.2)^3", steel));
      const auto load = [](const Point& x) { return -6 + 900 * std::pow(x.y() - 0.2, 3); };
      double most = 0;
      for (int t = 0; t < fields.triangles(); ++t) {
        const TriangleSums said = fields.said(t, 1e-8), seen = fields.seen(t, load);
        EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack + 1e-10 * seen.strain);
        most = std::max(most, std::abs(said.energy - seen.energy) / seen.strain);
      }
      EXPECT_GT(most, 1e-6);
    }
}

/// In doubles the load is a multiple of 2, in truth it is 7 x.
TEST(ElasticSums, AreOffByNoMoreThanWhatRoundingTakesFromALoad) {
  const ElasticFields fields(block(Scheme::conforming, "0", "(1e16 + 7*x) - 1e16", steel));
  const auto load = [](const Point& x) { return 7 * x.x(); };
  double most = 0;
  for (int t = 0; t < fields.triangles(); ++t) {
    const TriangleSums said = fields.said(t, 1e-8), seen = fields.seen(t, load);
    EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack);
    most = std::max(most, std::abs(said.energy - seen.energy) / seen.strain);
  }
  EXPECT_GT(most, 1e-3);
}

TEST(ElasticSums, AreOffByNoMoreThanTheirSlack) {
  const ElasticFields fields(
      block(Scheme::conforming, "0", "-6",
            YoungPoisson{problems::formula("1 + 0.5*sin(25*x - 7*y)"), Field(0.3), Plane::strain}));
  const auto load = [](const Point&) { return -6.; };
  double largest = 0, largest_of_energies = 0;
  for (int t = 0; t < fields.triangles(); ++t) {
    const TriangleSums said = fields.said(t, 0.3), seen = fields.seen(t, load);
    for (const auto sum : kSums) {
      EXPECT_LE(std::abs(said.*sum - seen.*sum), said.slack + 1e-9 * seen.stress);
      largest = std::max(largest, std::abs(said.*sum - seen.*sum) / seen.stress);
    }
    EXPECT_LE(std::abs(said.energy - seen.energy), said.energy_slack + 1e-9 * seen.strain);
    largest_of_energies = std::max(largest_of_energies, std::abs(said.energy - seen.energy) / seen.strain);
  }
  EXPECT_GT(largest, 1e-6);
  EXPECT_GT(largest_of_energies, 1e-9);
}

/// Of a load that waves too fast for any cells all is uncertain: its work on a body that is moved by 5 is
/// more than what its rest does on the bubbles.
TEST(ElasticSums, AreOffByTheUncertainWorkOfALoad) {
  for (const Scheme scheme : kSchemes) {
    Problem problem;
    problem.scheme = scheme;
    problem.mesh = {Divisions{2, 2}, Pattern::right};
    problem.material = steel;
    problem.body = VectorField(problems::formula("sin(1000000*x)"), Field(0));
    problem.boundary = {{"left", Fixed{VectorField(3, 4)}}};
    const ElasticFields fields(problem);
    const std::vector<TriangleSums> said = fields.said_of_all(1e-8);
    for (int t = 0; t < fields.triangles(); ++t) {
      const double work = 5 * fields.discretization().body[t].uncertain_work;
      EXPECT_GT(work, 0);
      EXPECT_GE(said[t].energy_slack, work);
    }
  }
}

}  // namespace
}  // namespace signorini::triangle_sums_test
