#include "certify/patches/patch_pairs.hpp"

#include <gtest/gtest.h>

#include "certificate_fields.hpp"
#include "certify/totals.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/submesh.hpp"
#include "problems/sanitized.hpp"

namespace signorini::patch_pairs_test {
namespace {

using Exact = problems::SignoriniEdge;

std::vector<std::unique_ptr<const PatchPairs>> pairs_of(CertificateFields& whole) {
  std::vector<std::unique_ptr<const PatchPairs>> all;
  for (Patch& patch : patches_where_pressure_changes(whole.discretization(), whole.pair().pressure))
    all.push_back(std::make_unique<const PatchPairs>(whole.discretization(), whole.solution().stress,
                                                     whole.pair(), std::move(patch), whole.progress()));
  return all;
}

/// The certificate's fields for the signorini-edge by the conforming scheme, and its patches.
class PatchPairsOfTheEdge : public testing::TestWithParam<int> {
 protected:
  PatchPairsOfTheEdge()
      : problem_(Exact::problem(Scheme::conforming, GetParam())),
        whole_(problem_,
               std::make_shared<const Mesh>(rectangle_mesh(std::get<Rectangle>(problem_.domain),
                                                           {2 * GetParam(), GetParam()}, Pattern::crossed))),
        all_(pairs_of(whole_)) {}

  Problem problem_;
  CertificateFields whole_;
  std::vector<std::unique_ptr<const PatchPairs>> all_;
};

/// The fields of a patch.
class OnPatch {
 public:
  explicit OnPatch(const PatchPairs& pairs) : pairs_(pairs), mesh_(*pairs.patch().mesh) {}

  Vector sigma_h(int t, const Point& x) const { return stress(pairs_.stress(), t, x); }
  Vector sigma(int t, const Point& x) const {
    return sigma_h(t, x) + stress(pairs_.change(), t, x) + curl_of(pairs_.first(), t, x);
  }
  Vector slope(int t, const Point& x) const {
    const Eigen::Matrix2d inverse = AffineMap(mesh_.corners(t)).jacobian.inverse();
    Tensor<1> slope = quadratic_slope(pairs_.first(), t, x);
    Eigen::Matrix<double, 1, 1> value = Eigen::Matrix<double, 1, 1>::Zero();
    pairs_.first().v.add_lifts<1>(t, x, inverse, value, slope);
    return slope;
  }
  Vector slope_of_w(int t, const Point& x) const {
    return quadratic_slope(pairs_.first(), t, x) - quadratic_slope(pairs_.second(), t, x);
  }
  Vector tau(int t, const Point& x) const {
    return curl_of(pairs_.first(), t, x) - curl_of(pairs_.second(), t, x);
  }
  double pressure(const AdmissiblePair& pair, int i, double s) const {
    return (1 - s) * pair.pressure.at_ends[i][0] + s * pair.pressure.at_ends[i][1];
  }
  double room(const AdmissiblePair& pair, int i, double s) const {
    return pair.v.room(pairs_.discretization().clearance.edges[i], s);
  }
  double w(int i, double s) const { return room(pairs_.second(), i, s) - room(pairs_.first(), i, s); }
  double pi(int i, double s) const {
    return pressure(pairs_.first(), i, s) - pressure(pairs_.second(), i, s);
  }

  /// From the singular point, or from the corner opposite a lifted edge.
  int corner(int t) const {
    for (int e = 0; e < 3; ++e) {
      const bool is_boundary = mesh_.edge_triangles[mesh_.triangle_edges[t][e]][1] < 0;
      if ((is_boundary && pairs_.first().v.is_lifted(t)) || mesh_.corners(t)[e].norm() == 0) return e;
    }
    return 0;
  }

 private:
  Vector stress(const Eigen::MatrixXd& coefficients, int t, const Point& x) const {
    return RaviartThomas(1).values(AffineMap(mesh_.corners(t)), x) * coefficients.col(t);
  }
  Vector curl_of(const AdmissiblePair& pair, int t, const Point& x) const {
    return curl(AffineMap(mesh_.corners(t)).jacobian.inverse(),
                pair.pressure.stream_function_on(mesh_, t) * quadratic_gradients(x).transpose());
  }
  Vector quadratic_slope(const AdmissiblePair& pair, int t, const Point& x) const {
    return gradient<1>(AffineMap(mesh_.corners(t)).jacobian.inverse(),
                       pair.v.on<1>(t) * quadratic_gradients(x).transpose());
  }

  const PatchPairs& pairs_;
  const Mesh& mesh_;
};

/// f(t, reference point), integrated over the patch.
template <typename Function>
double integrate_over(const PatchPairs& pairs, const Function& f) {
  const Mesh& mesh = *pairs.patch().mesh;
  const OnPatch on(pairs);
  double sum = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
    sum += AffineMap(mesh.corners(t)).determinant *
           integrate_from(on.corner(t), [&](const Point& x) { return f(t, x); });
  return sum;
}

/// f(i, s), integrated over the contact edges i of the patch, from their ends nearer to the origin.
template <typename Function>
double integrate_over_contact(const PatchPairs& pairs, const Function& f) {
  const Mesh& mesh = *pairs.patch().mesh;
  const std::vector<ContactEdge>& edges = pairs.discretization().clearance.edges;
  double sum = 0;
  for (int i = 0; i < static_cast<int>(edges.size()); ++i) {
    const auto& [first, second] = mesh.edges[edges[i].edge];
    const Point a = mesh.points[first], b = mesh.points[second];
    const bool forward = a.norm() <= b.norm();
    sum += integrate_from(a, b, [&](double s) { return f(i, forward ? s : 1 - s); });
  }
  return sum;
}

/// What totals.hpp calls K, s and δ.
struct Sums {
  double known, span, correction, rest, moved;
};

Sums sums_of(const PatchPairs& pairs) {
  const OnPatch on(pairs);
  const auto s = [&](int t, const Point& x) -> Vector { return on.slope_of_w(t, x) + on.tau(t, x); };
  const auto delta = [&](int t, const Point& x) -> Vector { return on.sigma(t, x) - on.sigma_h(t, x); };
  const double by_area = integrate_over(pairs, [&](int t, const Point& x) {
    return (on.sigma(t, x) - on.slope(t, x)).dot(on.slope_of_w(t, x) - on.tau(t, x));
  });
  const double by_contact =
      2 * integrate_over_contact(pairs, [&](int i, double at) {
        return on.pressure(pairs.first(), i, at) * on.w(i, at) - on.pi(i, at) * on.room(pairs.first(), i, at);
      });
  return {by_area + by_contact,
          integrate_over(pairs, [&](int t, const Point& x) { return s(t, x).squaredNorm(); }),
          integrate_over(pairs, [&](int t, const Point& x) { return delta(t, x).squaredNorm(); }),
          integrate_over(pairs, [&](int t, const Point& x) { return (delta(t, x) - s(t, x)).squaredNorm(); }),
          integrate_over(pairs, [&](int t, const Point& x) { return on.slope_of_w(t, x).squaredNorm(); })};
}

/// (e + b, s) is K and what the exact pressure and displacement make of the rest.
TEST_P(PatchPairsOfTheEdge, KnowTheErrorAgainstTheirDifference) {
  ASSERT_FALSE(all_.empty());
  for (const auto& pairs : all_) {
    const OnPatch on(*pairs);
    const Mesh& mesh = *pairs->patch().mesh;
    const Sums sums = sums_of(*pairs);
    const double product = integrate_over(*pairs, [&](int t, const Point& x) {
      const Vector exact = Exact::stress(AffineMap(mesh.corners(t))(x));
      return (2 * exact - on.sigma(t, x) - on.slope(t, x)).dot(on.slope_of_w(t, x) + on.tau(t, x));
    });
    const double unknown = 2 * integrate_over_contact(*pairs, [&](int i, double s) {
                             const auto& [a, b] = mesh.edges[pairs->discretization().clearance.edges[i].edge];
                             const double x = (1 - s) * mesh.points[a].x() + s * mesh.points[b].x();
                             const double pressure = x < 0 ? 1.5 * std::sqrt(-x) : 0,
                                          room = x > 0 ? std::pow(x, 1.5) : 0;
                             return on.pi(i, s) * room - pressure * on.w(i, s);
                           });
    EXPECT_TRUE(pairs->are_admissible());
    // What is lifted is interpolated.
    EXPECT_NEAR(product, sums.known + unknown, 1e-8 * sums.span);
    EXPECT_LT(sums.rest, 0.3 * sums.correction);
  }
}

TEST(Totals, AddUpWhatTheBoundIsMadeOf) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Problem& problem :
       {Exact::problem(Scheme::conforming, 2), problems::paper(Scheme::conforming, 4)}) {
    const auto divisions = std::get<Divisions>(problem.mesh.fineness);
    CertificateFields whole(problem, std::make_shared<const Mesh>(rectangle_mesh(
                                         std::get<Rectangle>(problem.domain), divisions, Pattern::right)));
    for (const auto& pairs : pairs_of(whole)) {
      Totals totals(whole.discretization().triangles());
      totals.add<1>(pairs->discretization(), {problem.material, *pairs->patch().mesh, 1e-8, whole.progress()},
                    pairs->first(), MembraneSums(*pairs), pairs->patch().parents, whole.progress(),
                    &pairs->second());
      const Sums sums = sums_of(*pairs);
      // Lifts are integrated by a quadrature.
      EXPECT_NEAR(totals.all.known, sums.known, 1e-5 * sums.span);
      EXPECT_NEAR(totals.all.span, sums.span, 1e-9 * sums.span);
      EXPECT_NEAR(totals.all.correction, sums.correction, 1e-9 * sums.span);
      EXPECT_NEAR(totals.all.moved, sums.moved, 1e-9 * sums.span);
      EXPECT_GT(sums.moved, 1e-3 * sums.span);
      EXPECT_NEAR(sums.correction - 2 * totals.all.along + sums.span, sums.rest, 1e-9 * sums.span);
    }
  }
}

TEST_P(PatchPairsOfTheEdge, AreAdmissible) {
  for (const auto& pairs : all_) {
    const std::vector<ContactEdge>& edges = pairs->discretization().clearance.edges;
    for (const AdmissiblePair* pair : {&pairs->first(), &pairs->second()})
      for (int i = 0; i < static_cast<int>(edges.size()); ++i)
        for (const double s : {0., 0.1, 0.3, 0.5, 0.8, 1.}) {
          EXPECT_GE(pair->pressure.at_ends[i][s > 0.5], 0);
          EXPECT_GE(pair->v.room(edges[i], s), -1e-12);
        }
  }
}

/// v and σ*n go on across the cut.
void expect_to_fit(const CertificateFields& of_whole,
                   const std::vector<std::unique_ptr<const PatchPairs>>& all) {
  for (const auto& pairs : all) {
    const OnPatch on(*pairs);
    const Mesh &mesh = *pairs->patch().mesh, &whole = of_whole.mesh();
    const auto cut = std::ranges::find(mesh.boundary, Submesh::kCut, &BoundaryPart::name);
    if (cut == mesh.boundary.end()) continue;
    for (const int edge : cut->edges) {
      const Point x = (mesh.points[mesh.edges[edge][0]] + mesh.points[mesh.edges[edge][1]]) / 2;
      const Vector normal = mesh.outward_normal(edge);
      const int t = mesh.edge_triangles[edge][0];
      const auto reference_in = [&](const Mesh& where, int triangle) -> Point {
        const AffineMap map(where.corners(triangle));
        return map.jacobian.inverse() * (x - map.origin);
      };
      const auto outside = std::ranges::find_if(pairs->patch().cut, [&](int candidate) {
        const Point &a = whole.points[whole.edges[candidate][0]],
                    &b = whole.points[whole.edges[candidate][1]];
        return (x - a).norm() + (b - x).norm() < (b - a).norm() * (1 + 1e-12);
      });
      ASSERT_NE(outside, pairs->patch().cut.end());
      for (const int neighbour : whole.edge_triangles[*outside])
        EXPECT_NEAR(normal.dot(on.sigma(t, reference_in(mesh, t))),
                    normal.dot(of_whole.admissible_stress(neighbour, reference_in(whole, neighbour))), 1e-10);
      const Point &a = whole.points[whole.edges[*outside][0]], &b = whole.points[whole.edges[*outside][1]];
      const double s = (x - a).norm() / (b - a).norm();
      for (const AdmissiblePair* pair : {&pairs->first(), &pairs->second()})
        EXPECT_NEAR(pair->v.on_edge(edge, 0.5)[0], of_whole.pair().v.on_edge(*outside, s)[0], 1e-12);
    }
  }
}

TEST_P(PatchPairsOfTheEdge, FitTheirSurroundings) {
  expect_to_fit(whole_, all_);
}

/// A load that varies besides, so that σ* has the stream function of its balance; and contact that stays
/// closed up to a corner.
TEST(PatchPairs, OfARandomProblemFitTheirSurroundingsAndTheError) {
  Problem problem = problems::random(7);
  problem.scheme = Scheme::conforming;
  CertificateFields whole(problem, std::make_shared<const Mesh>(rectangle_mesh(
                                       std::get<Rectangle>(problem.domain),
                                       std::get<Divisions>(problem.mesh.fineness), problem.mesh.pattern)));
  ASSERT_TRUE(whole.pair().of_balance.has_value());
  const auto all = pairs_of(whole);
  ASSERT_EQ(all.size(), 2u);
  expect_to_fit(whole, all);
  for (const auto& pairs : all) {
    Totals totals(whole.discretization().triangles());
    totals.add<1>(pairs->discretization(), {problem.material, *pairs->patch().mesh, 1e-8, whole.progress()},
                  pairs->first(), MembraneSums(*pairs), pairs->patch().parents, whole.progress(),
                  &pairs->second());
    const TriangleSums& sums = totals.all;
    EXPECT_LT(sums.correction - 2 * sums.along + sums.span, 0.03 * sums.correction);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, PatchPairsOfTheEdge,
                         testing::ValuesIn(sanitized ? std::vector{2} : std::vector{2, 6}));

TEST(Totals, FindTheLeastOverTheWay) {
  for (const double known : {-3., -0.2, 0., 0.1, 0.5, 4.})
    for (const double s_delta : {-0.5, 0.2, 0.9, 1.9}) {
      constexpr double delta_square = 2, s_square = 2, radius = 0.7;
      double least = std::numeric_limits<double>::infinity();
      for (int i = 0; i <= 10000; ++i) {
        const double theta = 1e-4 * i;
        least = std::min(least,
                         radius * std::sqrt(delta_square - 2 * theta * s_delta + theta * theta * s_square) +
                             theta * known);
      }
      EXPECT_NEAR(least_over_the_way(delta_square, s_square, s_delta, radius, known), least, 1e-6);
    }
  EXPECT_EQ(least_over_the_way(4, 0, 0, 3, 0), 6);
}

/// A modulus that is linear counts exactly: what many steps leave is the quadratic displacement of least
/// energy.
TEST(Relaxation, TendsToTheLeastEnergyWhereTheModulusVaries) {
  Problem problem = problems::paper(Scheme::conforming, 4);
  const auto rising = [](double by_x, double by_y) {
    return problems::function([=](const Point& x) { return 1 + by_x * x.x() + by_y * x.y(); });
  };
  problem.material = MembraneStiffness{rising(2, 1), Field(0.3), rising(-0.5, 3)};
  const Mesh mesh = rectangle_mesh(std::get<Rectangle>(problem.domain), {4, 4}, Pattern::right);
  const Discretization discretization(problem, mesh);
  QuadraticValues v(mesh);
  for (const BoundaryPart& part : mesh.boundary)
    for (const int edge : part.edges) v.hold(mesh, edge);
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Eigen::VectorXd work = work_of_loads(discretization, progress);
  relax(discretization, stiffness_of, v, work, 500, progress);
  LawField<1> law(problem.material);
  const Eigen::VectorXd reaction = work_of_stress(discretization, [&](int t) {
    const AffineMap map(mesh.corners(t));
    StressAtPoints stress;
    for (int q = 0; q < TriangleRule::size; ++q)
      stress.col(q) =
          law(map(triangle_rule().points[q])).stiffness *
          gradient<1>(map.jacobian.inverse(), v.on(mesh, t) * quadratic_gradients()[q].transpose());
    return stress;
  });
  ASSERT_GT(work.norm(), 0.1);
  const Eigen::Index points = v.points.size();
  for (Eigen::Index i = 0; i < work.size(); ++i)
    if (!(i < points ? v.held_points[i] : v.held_middles[i - points])) {
      EXPECT_NEAR(reaction[i], work[i], 1e-12);
    }
}

TEST(Relaxation, MeasuresACurlByTheGradient) {
  const Law<1> law(Eigen::Matrix2d{{2, 0.3}, {0.3, 0.7}});
  const Vector slope(0.4, -1.1), curl(slope.y(), -slope.x());
  EXPECT_NEAR(slope.dot(turned_compliance_of(law) * slope), curl.dot(law.compliance * curl), 1e-14);
}

/// What the rules miss of a law that waves: of the fields of a second pair, too, each twice.
TEST(PatchPairs, AreOffByWhatTheRulesMissOfBothPairs) {
  Problem problem = Exact::problem(Scheme::conforming, 8);
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.3*sin(9*x)"));
  CertificateFields whole(problem, std::make_shared<const Mesh>(rectangle_mesh(
                                       std::get<Rectangle>(problem.domain), {16, 8}, Pattern::crossed)));
  LawField<1> law(problem.material);
  int seen = 0;
  for (const auto& pairs : pairs_of(whole)) {
    const OnPatch on(*pairs);
    const Mesh& mesh = *pairs->patch().mesh;
    ShapeNorms norms;
    const LawOnMesh laws(problem.material, mesh, 0.3, whole.progress());
    for (int t = 0; t < pairs->discretization().triangles(); ++t) {
      const TriangleSums one = MembraneSums(pairs->discretization(), pairs->stress(), pairs->first(), norms)(
                             t, law, laws),
                         both = MembraneSums(*pairs)(t, law, laws);
      const double error = one.slack / (2 * one.stress + 3 * one.correction + 2 * one.strain);
      const AffineMap map(mesh.corners(t));
      const double tau = map.determinant * integrate_from(0, [&](const Point& x) {
                           const Vector own = on.tau(t, x);
                           const auto compliance = law(map(x)).compliance;
                           return own.dot(compliance * own);
                         });
      const double least =
          error * (2 * both.stress + 3 * both.correction + 2 * both.strain + 2 * both.moved + 2 * tau);
      EXPECT_GE(both.slack, least * (1 - 1e-3));
      seen += error > 0 && both.moved + tau > 1e-2 * both.stress;
    }
  }
  EXPECT_GT(seen, 10);
}

}  // namespace
}  // namespace signorini::patch_pairs_test
