// What a varying law is cut into.
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "certify/data/law_pieces.hpp"
#include "fem/cubature.hpp"
#include "fem/raviart_thomas.hpp"
#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"

namespace signorini::law_pieces_test {
namespace {

/// Entries of very different sizes, and waves that no triangle resolves: known to be positive definite all
/// the same, with few pieces.
TEST(LawPieces, OfATensorThatWavesAreAffordable) {
  for (const char* wave : {"(1+0.5*sin(20*x-9*y))", "(1+0.5*sin(200*x-90*y))"}) {
    const auto times = [&](double entry) { return problems::formula(problems::digits(entry) + "*" + wave); };
    const Material tensor = HookeTensor{{times(20), times(0.4), times(0.1), times(1), times(0), times(0.5)}};
    Observer observer;
    Progress progress(observer, std::nullopt);
    const Mesh mesh = rectangle_mesh(Rectangle{}, Divisions{2, 2}, Pattern::right);
    const LawOnMesh laws(tensor, mesh, 1e-6, progress);
    EXPECT_TRUE(laws.unmet().empty()) << wave;
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
      EXPECT_LE(laws.cut(t).size(), 100u) << wave;
      EXPECT_TRUE(std::isfinite(laws.whole(t).errors.back())) << wave;
      // The stiffest direction is that of xx, at the most 1.5 times 20.02.
      EXPECT_GE(laws.whole(t).stiffest, 20);
      EXPECT_LE(laws.whole(t).stiffest, 40);
    }
  }
}

constexpr const char* kCircle = "((x-0.5)^2+(y-0.5)^2 < 0.09 ? 5 : 1)";

/// A constant matrix times a scalar field.
std::vector<Material> tensors_times(const std::string& factor) {
  const auto times = [&](double entry) { return problems::formula(problems::digits(entry) + "*" + factor); };
  return {MembraneStiffness{times(2), times(0.5), times(1)},
          MembraneStiffness{times(0.245), times(-0.7427275), times(2.754)},
          HookeTensor{{times(3), times(1), times(0.2), times(2), times(0), times(1)}}};
}

TEST(LawPieces, AreDefiniteIfTheEntriesHaveAFactorInCommon) {
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Mesh mesh = rectangle_mesh(Rectangle{}, Divisions{2, 2}, Pattern::right);
  for (const std::string& factor :
       {std::string(kCircle), std::string("(1.5+sin(2.8*(1.5*x+1.6*y-0.5)))"),
        std::string("(abs(x-0.4123) < 0.1 ? 1 : 1000)"), std::string("max(0.1, 3*x-abs(y-0.3))")})
    for (const Material& tensor : tensors_times(factor)) {
      const LawOnMesh laws(tensor, mesh, 1e-6, progress);
      EXPECT_TRUE(laws.unmet().empty()) << factor;
      for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
        const LawPiece& whole = laws.whole(t);
        EXPECT_TRUE(whole.is_known()) << factor;
        const AffineMap map(mesh.corners(t));
        for (const Point& reference : triangle_rule().points) {
          const Eigen::VectorXd own =
              Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(compliance_at(tensor, map(reference)))
                  .eigenvalues();
          EXPECT_LE(own.maxCoeff(), whole.softest * (1 + 1e-12)) << factor;
          EXPECT_GE(own.minCoeff() * whole.stiffest, 1 - 1e-12) << factor;
        }
      }
    }
}

/// E = A and E = 5 A are off from 3 A by 2 A, twice what E is at least, and C is as much so.
TEST(LawPieces, OfAJumpBetweenTwoTensorsKnowBothOnAnyCell) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  for (const Material& tensor : tensors_times(kCircle)) {
    CellBudget none{0};
    const std::vector<LawPiece> pieces = law_pieces(tensor, corners, {1e-6, 1e-6}, none);
    ASSERT_EQ(pieces.size(), 1u);
    EXPECT_TRUE(pieces[0].jumps);
    for (int k = 1; k < LawPiece::kOrders; ++k) EXPECT_NEAR(pieces[0].errors[k], 2, 1e-9);
  }
}

std::vector<Material> smooth_membranes() {
  const std::string smooth = "exp(x)*(2+sin(5*y))";
  const auto times = [&](double entry) {
    return problems::formula(problems::digits(entry) + "*(" + smooth + ")");
  };
  return {MembraneStiffness::isotropic(times(1)), MembraneStiffness{times(1), Field(0), times(2)},
          MembraneStiffness{times(1), Field(0.1), times(3)}};
}

/// Lemma 4 of THEORY.md, for squares of a quadratic field.
TEST(LawPieces, TellWhatARuleMayMiss) {
  const std::array<Point, 3> corners{Point(0.1, 0.2), Point(0.5, 0.3), Point(0.2, 0.7)};
  const AffineMap map(corners);
  for (const Material& membrane : smooth_membranes())
    for (const double tolerance : {1e-2, 1e-5, 1e-9}) {
      CellBudget budget{400};
      const std::vector<LawPiece> pieces = law_pieces(membrane, corners, {tolerance, tolerance}, budget);
      for (const LawPiece& piece : pieces) {
        const auto integral = [&](const std::vector<WeightedPoint>& rule, bool of_compliance) {
          double sum = 0;
          for (const auto& [own, weight] : rule) {
            const Point x = map(piece.place(own));
            const Vector field(1 + x.x() * x.y(), x.y() * x.y() - 3 * x.x());
            const Eigen::Matrix2d compliance = compliance_at(membrane, x);
            const Eigen::Matrix2d law = of_compliance ? compliance : compliance.inverse();
            sum += weight * field.dot(law * field);
          }
          return sum;
        };
        const int degree = piece.degree_of_rule(2, tolerance);
        for (const bool of_compliance : {false, true}) {
          const double by_rule = integral(rule_of_degree(degree), of_compliance);
          EXPECT_NEAR(by_rule, integral(composite_rule(16), of_compliance),
                      (2 * piece.error_of_rule(degree, 2) + 1e-13) * by_rule);
        }
      }
    }
}

/// As near a polynomial as the certificate of a membrane on so fine a mesh asks for.
TEST(LawPieces, OfASmoothMembraneAreFew) {
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Mesh mesh = rectangle_mesh(Rectangle{}, Divisions{24, 24}, Pattern::right);
  const std::vector<Material> membranes = smooth_membranes();
  for (const bool isotropic : {true, false}) {
    const LawOnMesh laws(membranes[isotropic ? 0 : 1], mesh, 2e-11, progress);
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) EXPECT_LE(laws.cut(t).size(), 4u);
  }
}

TEST(LawPieces, ThatMayVanishAreTakenAsInPoints) {
  Observer observer;
  Progress progress(observer, std::nullopt);
  const Mesh mesh = rectangle_mesh(Rectangle{}, Divisions{2, 2}, Pattern::right);
  const Material vanishing =
      MembraneStiffness::isotropic(problems::formula("abs(x-0.4123)", "/material/stiffness"));
  const LawOnMesh laws(vanishing, mesh, 1e-6, progress);
  ASSERT_EQ(laws.unmet().size(), 1u);
  EXPECT_NE(laws.unmet()[0].find("not known to be positive definite"), std::string::npos);
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) EXPECT_TRUE(laws.whole(t).is_known());
}

}  // namespace
}  // namespace signorini::law_pieces_test
