// What a varying law is cut into.
#include <cmath>

#include <gtest/gtest.h>

#include "certificate_fields.hpp"
#include "certify/law_pieces.hpp"
#include "certify/triangle_sums.hpp"
#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"
#include "requested_mesh.hpp"

namespace signorini {
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

/// The integrals over a triangle by rules that look at the law coarsely, against those that look closely.
TEST(TriangleSums, AreOffByNoMoreThanTheirSlack) {
  Problem problem = problems::paper(Scheme::conforming, 3);
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.5*sin(9*x)"));
  Observer observer;
  Progress progress(observer, std::nullopt);
  CertificateFields fields(problem, requested_mesh(problem, progress));
  const MembraneSums sums(fields.discretization(), fields.solution().stress, fields.pair());
  LawField<1> law(problem.material);
  const LawOnMesh coarse(problem.material, fields.mesh(), 0.3, progress),
      close(problem.material, fields.mesh(), 1e-10, progress);
  double largest = 0;
  for (int t = 0; t < fields.discretization().triangles(); ++t) {
    const TriangleSums seen = sums(t, law, coarse), exact = sums(t, law, close);
    for (const auto sum : {&TriangleSums::gap, &TriangleSums::direct_gap, &TriangleSums::correction,
                           &TriangleSums::stress, &TriangleSums::strain}) {
      EXPECT_LE(std::abs(seen.*sum - exact.*sum), seen.slack + exact.slack);
      largest = std::max(largest, std::abs(seen.*sum - exact.*sum) / seen.stress);
    }
    EXPECT_LE(std::abs(seen.energy - exact.energy), seen.energy_slack + exact.energy_slack);
  }
  EXPECT_GT(largest, 1e-7);  // there is something that the slack has to pay for
}

}  // namespace
}  // namespace signorini
