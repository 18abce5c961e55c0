// What a varying law is cut into.
#include <cmath>

#include <gtest/gtest.h>

#include "certify/law_pieces.hpp"
#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"

namespace signorini {
namespace {

/// Entries of very different sizes, and waves that no triangle resolves: known to be positive definite all the same,
/// with few pieces.
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

}  // namespace
}  // namespace signorini
