// Both factorisations give the same answers, to 1e-10 of their size.
#include <gtest/gtest.h>

#include <filesystem>

#include "mesh/domain_mesh.hpp"
#include "problems/families.hpp"
#include "problems/same_answers.hpp"
#include "problems/sanitized.hpp"
#include "progress/memory_meter.hpp"
#include "run/study.hpp"
#include "system/cholmod.hpp"
#include "system/factorize.hpp"
#include "system/hybrid_system.hpp"

namespace signorini::factorization_test {
namespace {

struct Case {
  std::string name;
  Problem problem;
  Settings settings;

  friend void PrintTo(const Case& printed, std::ostream* out) { *out << printed.name; }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const std::string& name, const Problem& problem, const Method& method = ActiveSet{}) {
    all.push_back({name, problem, {method, {}}});
  };
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const std::string suffix = scheme == Scheme::conforming ? "Conforming" : "Nonconforming";
    add("Paper" + suffix, problems::paper(scheme, 12));
    add("PapersIteration" + suffix, problems::paper(scheme, 8), PaperUzawa{0.1, 1, 0.5, 1e-5, 1000});
    add("HalfDisc" + suffix, problems::half_disc(scheme));
    add("TouchingHole" + suffix, problems::touching_hole(scheme, 0.3, 12));
    add("LongContact" + suffix, [&] {
      Problem strip = problems::paper(scheme, 1);
      strip.domain = Rectangle{{0, 0}, {40, 1}};
      strip.mesh.fineness = Divisions{160, 4};
      return strip;
    }());
    add("NoContact" + suffix, [&] {
      Problem held = problems::paper(scheme, 4);
      held.boundary = {{"left", Fixed{}}};
      return held;
    }());
    add("OneSquare" + suffix, problems::paper(scheme, 1));
  }
  // The paper's problem, elastic blocks, random membranes, and what contact alone holds.
  const std::vector<Problem> families = problems::families();
  for (std::size_t i = 0; i < families.size(); i += sanitized ? 3 : 1)
    add("Family" + std::to_string(i), problems::with_other_data(families[i], static_cast<unsigned>(i)));
  for (unsigned seed = 5; seed < (sanitized ? 7 : 15); ++seed)
    add("Random" + std::to_string(seed), problems::random(seed));
  return all;
}

class Factorizations : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(Problems, Factorizations, testing::ValuesIn(cases()),
                         [](const auto& of) { return of.param.name; });

TEST_P(Factorizations, GiveTheSameAnswers) {
  Settings settings = GetParam().settings;
  const Solution ours = solve(GetParam().problem, settings);
  settings.factorization = Factorization::cholmod;
  expect_same_answers(solve(GetParam().problem, settings), ours);
}

/// Lengths, stiffness and displacements in other units.
TEST(FactorizationsInUnits, GiveTheSameAnswers) {
  for (const double length : {1e-9, 1e9})
    for (const double stiffness : {1e-9, 1e9}) {
      Problem problem = problems::block(Scheme::conforming, Pattern::alternating, 3 * stiffness, 0.3);
      problem.domain = Rectangle{{0, 0}, {2 * length, length}};
      problem.boundary = {{"left", Roller{}},
                          {"bottom", Contact{0.01 * length}},
                          {"top", Fixed{VectorField(0, -0.03 * length)}}};
      Settings settings{ActiveSet{}, {}};
      const Solution ours = solve(problem, settings);
      settings.factorization = Factorization::cholmod;
      expect_same_answers(solve(problem, settings), ours);
    }
}

TEST(FactorizationsOfSweeps, GiveTheSameEntries) {
  const Problem problem = problems::with_other_data(problems::elastic(Scheme::nonconforming, 0.3), 1);
  std::vector<Variation> sweep;
  for (const double young : {3., 4.}) {
    sweep.push_back({"", problem.body, problem.boundary, "same"});
    std::get<Contact>(sweep.back().boundary.at("bottom")).gap = 0.01;
    sweep.back().material =
        std::make_shared<const Material>(YoungPoisson{Field(young), Field(0.3), Plane::strain});
    sweep.back().material_key = std::to_string(young);
  }
  Observer indifferent;
  const auto entries = [&](Factorization by) {
    problems::Shelf shelf;
    return solve(problem, sweep, {ActiveSet{}, {}, 0, by}, indifferent, shelf).sweep;
  };
  const auto ours = entries(Factorization::multifrontal), cholmods = entries(Factorization::cholmod);
  ASSERT_EQ(cholmods.size(), ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    EXPECT_NEAR(cholmods[i].energy / ours[i].energy, 1, 1e-10);
    EXPECT_NEAR(cholmods[i].sums.force / ours[i].sums.force, 1, 1e-10);
  }
}

TEST(FactorizationsOfAMeshThatRefinesItself, GiveTheSameAnswers) {
  Problem problem = problems::paper(Scheme::nonconforming, 4);
  problem.mesh.adaptive = Adaptive{0.1, 2000};
  Settings settings{ActiveSet{}, {}};
  const Solution ours = solve(problem, settings);
  settings.factorization = Factorization::cholmod;
  expect_same_answers(solve(problem, settings), ours);
}

std::size_t threads() {
  const std::filesystem::directory_iterator tasks("/proc/self/task");
  return static_cast<std::size_t>(std::distance(begin(tasks), end(tasks)));
}

/// A matrix of a membrane, large enough for CHOLMOD to want threads.
HybridSystem system_of(int n, int& contact_unknowns) {
  const Problem problem = problems::paper(Scheme::conforming, n);
  const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
  const Discretization discretization(problem, mesh);
  contact_unknowns = discretization.clearance.unknowns;
  Observer indifferent;
  Progress progress(indifferent, {});
  return assemble(discretization, progress);
}

TEST(Cholmod, StartsNoThread) {
  int contact_unknowns = 0;
  const HybridSystem system = system_of(64, contact_unknowns);
  const std::size_t before = threads();
  Observer indifferent;
  Progress progress(indifferent, {});
  cholmod(system.matrix, contact_unknowns, progress);
  EXPECT_EQ(threads(), before);
}

TEST(Cholmod, TakesItsMemoryFromTheSolve) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  int contact_unknowns = 0;
  const HybridSystem system = system_of(32, contact_unknowns);
  Observer indifferent;
  Progress progress(indifferent, {});
  const MemoryMeter meter;
  const auto bytes = static_cast<std::int64_t>(cholmod(system.matrix, contact_unknowns, progress).bytes());
  EXPECT_GE(meter.peak(), bytes);
  const MemoryLimit little(static_cast<double>(bytes) / 2);
  EXPECT_THROW(cholmod(system.matrix, contact_unknowns, progress), OutOfMemory);
}

}  // namespace
}  // namespace signorini::factorization_test
