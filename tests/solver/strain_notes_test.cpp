// Bodies that deform more than the theory of small displacements describes say so.
#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "solve.hpp"

namespace signorini::strain_notes_test {
namespace {

bool says(const Solution& solution, const std::string& what) {
  return std::ranges::any_of(solution.summary.notes,
                             [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

/// A block that is 2 wide and 1 high, fixed on top, on a foundation that begins `overlap` inside it.
Solution pressed(double overlap, double unit) {
  Problem problem = problems::block(Scheme::nonconforming, Pattern::right, 200, 0.3);
  problem.domain = Rectangle{{0, 0}, {2 * unit, unit}};
  problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{-overlap * unit}}};
  return solve(problem, {ActiveSet{}, {}});
}

TEST(StrainNotes, SayThatAFoundationBeginsFarInsideTheBody) {
  for (const double unit : {1e-9, 1., 1e9}) {
    EXPECT_TRUE(says(pressed(0.5, unit), "small displacements"));
    EXPECT_FALSE(says(pressed(0.01, unit), "small displacements"));
    EXPECT_FALSE(says(pressed(0.5, unit), "inside out"));
    EXPECT_TRUE(says(pressed(1.5, unit), "inside out"));
  }
}

TEST(StrainNotes, SayThatALoadIsTooLarge) {
  for (const double load : {1., 1000.}) {
    Problem problem = problems::block(Scheme::conforming, Pattern::right, 200, 0.3);
    problem.boundary = {
        {"left", Fixed{}}, {"bottom", Contact{0.01}}, {"top", Traction{VectorField(0, -load)}}};
    EXPECT_EQ(says(solve(problem, {ActiveSet{}, {}}), "small displacements"), load == 1000) << load;
  }
}

}  // namespace
}  // namespace signorini::strain_notes_test
