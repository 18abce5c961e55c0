// What makes the certificate's pair of an elastic body better: relaxation on the stars of points.
#include <gtest/gtest.h>

#include <random>

#include <Eigen/Cholesky>

#include "certify/displacement/star_relaxation.hpp"
#include "certify/elasticity/johnson_mercier_data.hpp"
#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "certify/elasticity/traction_relaxation.hpp"
#include "certify/triangle_sums.hpp"
#include "mesh/rectangle.hpp"
#include "problems/families.hpp"
#include "run/requested_mesh.hpp"
#include "solved_problem.hpp"

namespace signorini::star_relaxation_test {
namespace {

/// Random positive definite forms on a mesh, with some unknowns that are held.
TriangleForms random_forms(const Mesh& mesh, bool edges_are_odd, std::mt19937& random) {
  std::normal_distribution<double> normal;
  TriangleForms forms;
  if (edges_are_odd) forms.per_point = 3, forms.per_edge = 1;
  forms.edges_are_odd = edges_are_odd;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    TriangleForms::Matrix factor;
    TriangleForms::Vector slope;
    for (double& entry : factor.reshaped()) entry = normal(random);
    for (double& entry : slope) entry = normal(random);
    forms.matrix_of.push_back(forms.keep(factor * factor.transpose()));
    forms.slopes.push_back(slope);
  }
  for (Eigen::Index i = 0; i < forms.unknowns(mesh); ++i) forms.held.push_back(random() % 7 == 0);
  return forms;
}

/// The same as one matrix and one slope: the functions of a triangle by the unknowns of the mesh.
struct Whole {
  Whole(const Mesh& mesh, const TriangleForms& forms) {
    const Eigen::Index size = forms.unknowns(mesh);
    matrix = Eigen::MatrixXd::Zero(size, size);
    slope = Eigen::VectorXd::Zero(size);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      Eigen::MatrixXd own = Eigen::MatrixXd::Zero(TriangleForms::kLocal, size);
      int row = 0;
      for (const int point : mesh.triangles[t])
        for (int k = 0; k < forms.per_point; ++k) own(row++, forms.of_point(point) + k) = 1;
      for (int e = 0; e < 3; ++e) {
        const bool falls = mesh.triangles[t][(e + 1) % 3] > mesh.triangles[t][(e + 2) % 3];
        for (int k = 0; k < forms.per_edge; ++k)
          own(row++, forms.of_edge(mesh, mesh.triangle_edges[t][e]) + k) =
              forms.edges_are_odd && falls ? -1 : 1;
      }
      matrix += own.transpose() * forms.matrices[forms.matrix_of[t]] * own;
      slope += own.transpose() * forms.slopes[t];
    }
    for (Eigen::Index i = 0; i < size; ++i)
      if (forms.held[i]) {
        matrix.row(i).setZero();
        matrix.col(i).setZero();
        matrix(i, i) = 1;
        slope[i] = 0;
      }
  }

  double operator()(const Eigen::VectorXd& x) const { return x.dot(matrix * x) / 2 + slope.dot(x); }

  Eigen::MatrixXd matrix;
  Eigen::VectorXd slope;
};

TEST(StarRelaxation, LowersTheFormUntilItIsTheLeast) {
  Observer observer;
  Progress progress(observer, std::nullopt);
  std::mt19937 random(1);
  Problem problem;
  problem.mesh = {Divisions{3, 2}, Pattern::crossed};
  const auto mesh = requested_mesh(problem, progress);
  for (const bool edges_are_odd : {false, true}) {
    const TriangleForms forms = random_forms(*mesh, edges_are_odd, random);
    const Whole whole(*mesh, forms);
    double before = 0;
    for (const int sweeps : {1, 2, 3, 4, 8}) {
      const double now = whole(relax_stars(*mesh, forms, sweeps, progress));
      EXPECT_LT(now, before);
      before = now;
    }
    const Eigen::VectorXd least = -whole.matrix.llt().solve(whole.slope);
    const Eigen::VectorXd found = relax_stars(*mesh, forms, 3000, progress);
    EXPECT_LE((found - least).norm(), 1e-6 * least.norm());
  }
}

/// ‖σ* − sym σ_h‖²_C.
double distance_square(const SolvedProblem& solved, const EdgeTractions& tractions) {
  LawField<2> law(solved.problem.material);
  double sum = 0;
  for (int t = 0; t < solved.discretization.triangles(); ++t) {
    const AffineMap map(solved.solution.mesh->corners(t));
    const JohnsonMercierRule& rule = johnson_mercier_rule(solved.discretization.spaces(), 10);
    const std::vector<SymmetricLaw> laws = laws_at(solved.discretization, rule, map, law);
    JohnsonMercierFields<1> fields(
        map, {johnson_mercier_data(solved.discretization, tractions, t, map), solved.solution.stress.col(t),
              Eigen::Matrix<double, 12, 1>::Zero()});
    const auto values = minimized(fields, rule, laws, std::span<const Eigen::Vector3d>());
    sum += JohnsonMercierOperators<1>(rule, map, values, laws).correction.squaredNorm();
  }
  return sum;
}

/// ½ ‖ε(v)‖²_E − (f, v), with what v is inside the macro-elements.
double energy(const SolvedProblem& solved, const AdmissibleDisplacement& v, const EdgeTractions& tractions) {
  const LawOnMesh laws(solved.problem.material, *solved.solution.mesh, 1e-8, solved.progress);
  ShapeNorms norms;
  ElasticSums sums(solved.discretization, solved.solution, v, tractions, norms);
  LawField<2> law(solved.problem.material);
  double sum = 0;
  for (int t = 0; t < solved.discretization.triangles(); ++t) sum += sums(t, law, laws).energy;
  return sum;
}

std::vector<Problem> bodies(Scheme scheme) {
  Problem varies = punch(scheme);
  varies.material =
      YoungPoisson{problems::formula("1 + x^2 + y"), problems::formula("0.2 + 0.2 * x"), Plane::strain};
  Problem hardly_compressible = punch(scheme);
  hardly_compressible.material = YoungPoisson{Field(2), Field(0.4999), Plane::strain};
  Problem rolls = punch(scheme);
  rolls.boundary["right"] = Roller{};
  rolls.boundary["top"] = Fixed{VectorField(0, -0.05)};
  return {punch(scheme), varies, hardly_compressible, rolls};
}

TEST(TractionRelaxation, TakesTheStressNearerToThatOfTheScheme) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Problem& problem : bodies(scheme)) {
      const SolvedProblem solved(problem, solve(problem, {ActiveSet{}, {}}));
      const ContactPressure pressure(solved.discretization, solved.solution.stress, solved.clearance);
      EdgeTractions tractions(solved.discretization, solved.solution.stress, pressure, solved.progress);
      const double before = distance_square(solved, tractions);
      relax_tractions(solved.discretization, solved.solution.stress, tractions, 2, solved.progress);
      const double after = distance_square(solved, tractions);
      EXPECT_LE(after, 0.8 * before);
      relax_tractions(solved.discretization, solved.solution.stress, tractions, 100, solved.progress);
      const double least = distance_square(solved, tractions);
      EXPECT_LE(least, after * (1 + 1e-12));
      EXPECT_GE(least, 0.4 * after);
    }
}

TEST(DisplacementRelaxation, LowersTheEnergyAndKeepsWhatIsGiven) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Problem& problem : bodies(scheme)) {
      const SolvedProblem solved(problem, solve(problem, {ActiveSet{}, {}}));
      const ContactPressure pressure(solved.discretization, solved.solution.stress, solved.clearance);
      const EdgeTractions tractions(solved.discretization, solved.solution.stress, pressure, solved.progress);
      AdmissibleDisplacement v = solved.displacement();
      const double before = energy(solved, v, tractions);
      v.relax_on_stars(1, solved.progress);
      EXPECT_TRUE(v.unmet().empty());
      EXPECT_LT(energy(solved, v, tractions), before);
      const Mesh& mesh = *solved.solution.mesh;
      const bool rolls = problem.boundary.contains("right");
      for (const BoundaryPart& part : mesh.boundary)
        for (const int edge : part.edges)
          for (const double s : {0., 0.2, 0.5, 0.9, 1.}) {
            const Eigen::VectorXd value = v.on_edge(edge, s);
            if (part.name == "top") {
              EXPECT_LE((value - Eigen::Vector2d(rolls ? 0 : 0.02, -0.05)).norm(), 1e-12);
            }
            if (rolls && part.name == "right") {
              EXPECT_NEAR(value[0], 0, 1e-12);
            }
          }
      for (const ContactEdge& contact : solved.discretization.clearance.edges)
        for (const double s : {0., 0.2, 0.5, 0.9, 1.}) EXPECT_GE(v.room(contact, s), -1e-11);
    }
}

}  // namespace
}  // namespace signorini::star_relaxation_test
