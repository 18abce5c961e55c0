// A solve is the same to the last bit whoever helps it.

#include <gtest/gtest.h>

#include "problems/elasticity.hpp"
#include "problems/families.hpp"
#include "problems/membrane.hpp"
#include "problems/threads.hpp"

namespace signorini::threads_test {
namespace {

Solution solved(const Problem& problem, Method method, Executor* executor) {
  Settings settings;
  settings.method = method;
  settings.executor = executor;
  return solve(problem, settings);
}

void expect_same(const EnclosedNumber& one, const EnclosedNumber& other) {
  EXPECT_EQ(one.value, other.value);
  EXPECT_EQ(one.lower, other.lower);
  EXPECT_EQ(one.upper, other.upper);
}

void expect_same(const Solution& one, const Solution& other) {
  EXPECT_TRUE(one.stress == other.stress);
  EXPECT_TRUE(one.displacement == other.displacement);
  EXPECT_EQ(one.summary.energy, other.summary.energy);
  ASSERT_TRUE(one.summary.error_bound && other.summary.error_bound);
  EXPECT_EQ(one.summary.error_bound->value, other.summary.error_bound->value);
  ASSERT_EQ(one.summary.certified.has_value(), other.summary.certified.has_value());
  if (!one.summary.certified) return;
  const auto &of_one = one.summary.certified->supports, &of_other = other.summary.certified->supports;
  ASSERT_EQ(of_one.size(), of_other.size());
  for (std::size_t i = 0; i < of_one.size(); ++i)
    for (std::size_t k = 0; k < of_one[i].force.size(); ++k)
      expect_same(of_one[i].force[k], of_other[i].force[k]);
}

/// Of several parts: more triangles than one has.
void expect_the_same_by_threads(const Problem& problem, Method method = ActiveSet{}) {
  const Solution alone = solved(problem, method, nullptr);
  EXPECT_GT(alone.summary.triangles, 8192);
  for (const int count : {2, 5}) {
    Threads threads(count);
    expect_same(solved(problem, method, &threads), alone);
  }
}

Polygon plate_with_a_hole() {
  Polygon polygon;
  polygon.vertices = {{0, 0}, {2, 0}, {2, 1}, {1, 1.2}, {0, 1}};
  polygon.sides = {"bottom", "right", "top", "top", "left"};
  return polygon;
}

class Threaded : public testing::TestWithParam<Scheme> {};

TEST_P(Threaded, MembranesAreTheSame) {
  expect_the_same_by_threads(problems::paper(GetParam(), 80));
  expect_the_same_by_threads(problems::paper(GetParam(), 72), Mprgp{});
  expect_the_same_by_threads(problems::with_other_data(problems::paper(GetParam(), 66), 3));
}

TEST_P(Threaded, BodiesAreTheSame) {
  Problem block = problems::with_other_data(problems::elastic(GetParam(), 0.3), 5);
  block.mesh.fineness = Divisions{80, 60};
  expect_the_same_by_threads(block);
  block.domain = plate_with_a_hole();
  block.mesh = {};
  block.mesh.fineness = LargestEdge{0.03};
  expect_the_same_by_threads(block);
}

TEST_P(Threaded, LawsThatVaryAndQuantitiesAreTheSame) {
  Problem problem = problems::random(2);
  problem.scheme = GetParam();
  problem.mesh = {};
  problem.mesh.fineness = Divisions{66, 66};
  expect_the_same_by_threads(problem);
}

INSTANTIATE_TEST_SUITE_P(Schemes, Threaded, testing::Values(Scheme::conforming, Scheme::nonconforming),
                         [](const auto& scheme) {
                           return scheme.param == Scheme::conforming ? "Conforming" : "Nonconforming";
                         });

}  // namespace
}  // namespace signorini::threads_test
