/// Our factorisation beside CHOLMOD's, in our order and in its own, on the same matrix, from its elements to
/// the contact complement and one solution. Seconds on the BLAS threads of OPENBLAS_NUM_THREADS, memory of
/// the factor and at its peak, and operations in the panels. And the whole solve of the same problem: mesh,
/// elements, factor, contact, fields, residuals and the bound.

#include <cmath>

#include <benchmark/benchmark.h>

#include "mesh/domain_mesh.hpp"
#include "problems/elasticity.hpp"
#include "progress/memory_meter.hpp"
#include "solve.hpp"
#include "system/cholmod.hpp"
#include "system/hybrid_system.hpp"
#include "system/multifrontal.hpp"

namespace signorini {
namespace {

struct AssembledProblem {
  AssembledProblem(const Problem& problem) : mesh(make_domain_mesh(problem.domain, problem.mesh)) {
    Observer indifferent;
    Progress progress(indifferent, {});
    const Discretization discretization(problem, mesh);
    system = assemble(discretization, progress);
    contact_unknowns = discretization.clearance.unknowns;
  }

  Mesh mesh;
  HybridSystem system;
  int contact_unknowns;
};

Problem membrane(int n) {
  return problems::paper(Scheme::nonconforming, n);
}

Problem elastic_block(int n) {
  Problem problem = problems::pressed_block(Scheme::nonconforming, Pattern::right, 0.3, 1);
  problem.mesh.fineness = Divisions{n, n};
  problem.boundary["left"] = Fixed{};
  return problem;
}

using Way = Factor (*)(const ElementSum&, int trailing, Progress&);

Factor cholmod_given(const ElementSum& matrix, int trailing, Progress& progress) {
  return cholmod(matrix, trailing, progress, CholmodOrder::given);
}
Factor cholmod_own(const ElementSum& matrix, int trailing, Progress& progress) {
  return cholmod(matrix, trailing, progress, CholmodOrder::own);
}

/// Multiplications and additions of an elimination by these panels.
double products(const Panels& panels) {
  double sum = 0;
  for (const Panels::Panel& panel : panels.all)
    for (int k = 0; k < panel.pivots; ++k) sum += std::pow(panel.size - k, 2);
  return sum;
}

void factor(benchmark::State& state, Way way, Problem (*make)(int)) {
  const AssembledProblem assembled(make(static_cast<int>(state.range(0))));
  const Eigen::VectorXd closed = Eigen::VectorXd::Zero(assembled.contact_unknowns);
  Observer indifferent;
  for (auto _ : state) {
    const MemoryMeter memory;
    Progress progress(indifferent, {});
    const Factor factor = way(assembled.system.matrix, assembled.contact_unknowns, progress);
    Factor::Workspace workspace;
    benchmark::DoNotOptimize(factor.expand(factor.condense(assembled.system.right, workspace, progress),
                                           closed, workspace, progress));
    state.counters["megabytes"] = static_cast<double>(factor.bytes()) / 1e6;
    state.counters["peak_megabytes"] = static_cast<double>(memory.peak()) / 1e6;
    state.counters["gigaflops"] = products(factor.panels()) / 1e9;
  }
  state.counters["unknowns"] = assembled.system.matrix.size;
}

void whole_solve(benchmark::State& state, Problem (*make)(int)) {
  const Problem problem = make(static_cast<int>(state.range(0)));
  double certify = 0, total = 0;
  for (auto _ : state) {
    const Timings timings = solve(problem, {ActiveSet{}, {}}).summary.timings;
    certify += timings.certify;
    total += timings.total;
  }
  state.counters["certificate_part"] = certify / total;
}

/// Divisions of a side, doubled from the smallest to the largest.
template <int smallest, int largest>
void sizes(benchmark::internal::Benchmark* each) {
  each->RangeMultiplier(2)->Range(smallest, largest)->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(factor, multifrontal_membrane, multifrontal, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, cholmod_given_membrane, cholmod_given, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, cholmod_own_membrane, cholmod_own, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(whole_solve, membrane, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, multifrontal_elastic_block, multifrontal, elastic_block)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, cholmod_given_elastic_block, cholmod_given, elastic_block)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, cholmod_own_elastic_block, cholmod_own, elastic_block)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(whole_solve, elastic_block, elastic_block)->Apply(sizes<128, 1024>);

}  // namespace
}  // namespace signorini
