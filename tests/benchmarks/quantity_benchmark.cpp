/// What intervals take beside the solve: those of every answer (`summary.certified`) and those of named
/// quantities in the entries of a sweep. Both of one run, so that the machine drops out of the ratio.

#include <algorithm>
#include <functional>

#include <benchmark/benchmark.h>

#include "problems/elasticity.hpp"
#include "problems/membrane.hpp"
#include "problems/no_cache.hpp"
#include "problems/seconds_at_work.hpp"
#include "run/certified.hpp"
#include "run/condensed_problem.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

using problems::formula;

/// A membrane that sags onto a curved foundation.
Problem membrane(Scheme scheme, int n) {
  Problem problem = problems::paper(scheme, n);
  problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{formula("0.1 + 0.3 * (x - 0.4)^2")}}};
  problem.body = VectorField(Field(-3));
  return problem;
}

/// The paper's, with four supports.
Problem paper(Scheme scheme, int n) {
  return problems::paper(scheme, n);
}

/// A block that hangs from above and sags onto one.
Problem block(Scheme scheme, int n) {
  return problems::hanging_block(scheme, n);
}

double seconds_of(const std::function<void()>& work) {
  const double begin = seconds_at_work();
  work();
  return seconds_at_work() - begin;
}

double median(std::vector<double> all) {
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2));
  return all[all.size() / 2];
}

const Settings exactly{ActiveSet{}, {}};

/// Shows the operator of a solve.
struct Last : NoCache {
  std::shared_ptr<const Operator> last;
  bool keep(const std::string&, std::shared_ptr<const Operator> own) override {
    last = std::move(own);
    return true;
  }
};

/// The solve with the intervals of every answer, over the one without: they are found once more, with what
/// the solve has at hand for them, the discretization and how the factorisation cut the mesh.
void standard_intervals(benchmark::State& state, Problem (*make)(Scheme, int), Scheme scheme) {
  Problem problem = make(scheme, static_cast<int>(state.range(0)));
  problem.operator_key = "the only one";
  std::vector<double> ratios;
  for (auto _ : state) {
    Solution solution;
    Observer indifferent;
    Last used;
    const double with = seconds_of([&] { solution = solve(problem, exactly, indifferent, used); });
    const Discretization discretization(problem, *solution.mesh);
    const std::shared_ptr<const ElementTree> tree = used.last->factor().tree();
    used.last.reset();
    Progress progress(indifferent, {});
    const double intervals =
        seconds_of([&] { add_certified(problem, exactly, progress, solution, &discretization, tree); });
    ratios.push_back(with / (with - intervals));
  }
  state.counters["ratio"] = median(std::move(ratios));
}

enum class Kind { pressure_force, reaction, mean };

Quantity quantity(Kind kind, int components) {
  Quantity own;
  own.name = "own";
  if (kind == Kind::pressure_force) own.weights = {{"bottom", formula("1 + x")}};
  if (kind == Kind::reaction) own.motions = {{"top", {components == 1 ? Vector(1, 0) : Vector(0, 1), 0}}};
  if (kind == Kind::mean)
    own.density =
        components == 1 ? VectorField(formula("x * (1 - x)")) : VectorField(Field(0), formula("x * (1 - x)"));
  return own;
}

/// Loads that grow, and with them the contact.
std::vector<Variation> growing_loads(const Problem& problem) {
  std::vector<Variation> sweep;
  for (int k = 0; k < 16; ++k) {
    Variation& own = sweep.emplace_back();
    own.boundary = problem.boundary;
    const Field load((components(problem.material) == 1 ? -3 : -4) * (1 + 0.02 * k));
    own.body = components(problem.material) == 1 ? VectorField(load) : VectorField(Field(0), load);
  }
  return sweep;
}

/// What a named quantity takes in an entry of a sweep, over what the entry itself does.
void named_quantity(benchmark::State& state, Problem (*make)(Scheme, int), Scheme scheme, Kind kind) {
  Problem problem = make(scheme, static_cast<int>(state.range(0)));
  const std::vector<Variation> sweep = growing_loads(problem);
  const Quantity own = quantity(kind, components(problem.material));
  Observer indifferent;
  NoCache none;
  const auto seconds_of_entries = [&] {
    const double alone = seconds_of([&] { solve(problem, {}, exactly, indifferent, none); });
    return seconds_of([&] { solve(problem, sweep, exactly, indifferent, none); }) - alone;
  };
  std::vector<double> ratios;
  for (auto _ : state) {
    problem.quantities.clear();
    const double without = seconds_of_entries();
    problem.quantities = {own};
    ratios.push_back((seconds_of_entries() - without) / without);
  }
  state.counters["ratio"] = median(std::move(ratios));
}

void sizes(benchmark::internal::Benchmark* each) {
  each->Arg(16)->Arg(64)->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(standard_intervals, membrane_nonconforming, membrane, Scheme::nonconforming)->Apply(sizes);
BENCHMARK_CAPTURE(standard_intervals, membrane_conforming, membrane, Scheme::conforming)->Apply(sizes);
BENCHMARK_CAPTURE(standard_intervals, paper_nonconforming, paper, Scheme::nonconforming)->Apply(sizes);
BENCHMARK_CAPTURE(standard_intervals, block_nonconforming, block, Scheme::nonconforming)->Apply(sizes);
BENCHMARK_CAPTURE(standard_intervals, block_conforming, block, Scheme::conforming)->Apply(sizes);

#define NAMED_QUANTITIES(problem, scheme)                                                                   \
  BENCHMARK_CAPTURE(named_quantity, problem##_##scheme##_pressure_force, problem, Scheme::scheme,           \
                    Kind::pressure_force)                                                                   \
      ->Apply(sizes);                                                                                       \
  BENCHMARK_CAPTURE(named_quantity, problem##_##scheme##_reaction, problem, Scheme::scheme, Kind::reaction) \
      ->Apply(sizes);                                                                                       \
  BENCHMARK_CAPTURE(named_quantity, problem##_##scheme##_mean, problem, Scheme::scheme, Kind::mean)         \
      ->Apply(sizes)

NAMED_QUANTITIES(membrane, nonconforming);
NAMED_QUANTITIES(membrane, conforming);
NAMED_QUANTITIES(block, nonconforming);
NAMED_QUANTITIES(block, conforming);

}  // namespace
}  // namespace signorini
