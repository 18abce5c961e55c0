/// The factorisation beside bare CHOLMOD on the same matrix, from its elements to one solution: CHOLMOD puts
/// the matrix together, orders it by AMD with no regard to contact, factors by supernodes and solves. Seconds
/// on the BLAS threads of OPENBLAS_NUM_THREADS. And the whole solve of the same problem: mesh, elements,
/// factor, contact, fields, residuals and the bound.

#include <benchmark/benchmark.h>
#include <cholmod.h>

#include "mesh/domain_mesh.hpp"
#include "problems/elasticity.hpp"
#include "solve.hpp"
#include "system/cholesky.hpp"
#include "system/hybrid_system.hpp"

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
  problem.boundary["left"] =
      Fixed{};  // held by contact alone, the matrix would be singular, no food for CHOLMOD
  return problem;
}

void factor(benchmark::State& state, Problem (*make)(int)) {
  const AssembledProblem assembled(make(static_cast<int>(state.range(0))));
  const Eigen::VectorXd closed = Eigen::VectorXd::Zero(assembled.contact_unknowns);
  Observer indifferent;
  for (auto _ : state) {
    Progress progress(indifferent, {});
    const Cholesky factor(assembled.system.matrix, assembled.contact_unknowns, progress);
    Cholesky::Workspace workspace;
    benchmark::DoNotOptimize(factor.expand(factor.condense(assembled.system.right, workspace, progress),
                                           closed, workspace, progress));
  }
  state.counters["unknowns"] = assembled.system.matrix.size;
}

cholmod_sparse* put_together(const ElementSum& sum, cholmod_common& common) {
  const std::size_t n = sum.per_element, size = sum.size;
  cholmod_triplet* triplets =
      cholmod_allocate_triplet(size, size, sum.elements() * n * (n + 1) / 2, -1, CHOLMOD_REAL, &common);
  std::size_t& count = triplets->nnz;
  for (int element = 0; element < sum.elements(); ++element) {
    const auto unknowns = sum.unknowns_of(element);
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = j; i < n; ++i) {
        if (unknowns[i] < 0 || unknowns[j] < 0) continue;
        static_cast<int*>(triplets->i)[count] = std::max(unknowns[i], unknowns[j]);
        static_cast<int*>(triplets->j)[count] = std::min(unknowns[i], unknowns[j]);
        static_cast<double*>(triplets->x)[count++] = sum.matrix(element)[j * n + i];
      }
  }
  cholmod_sparse* matrix = cholmod_triplet_to_sparse(triplets, 0, &common);
  cholmod_free_triplet(&triplets, &common);
  return matrix;
}

void bare_cholmod(benchmark::State& state, Problem (*make)(int)) {
  const AssembledProblem assembled(make(static_cast<int>(state.range(0))));
  cholmod_common common;
  cholmod_start(&common);
  common.supernodal = CHOLMOD_SUPERNODAL;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_AMD;
  cholmod_dense* right = cholmod_ones(assembled.system.matrix.size, 1, CHOLMOD_REAL, &common);
  for (auto _ : state) {
    cholmod_sparse* matrix = put_together(assembled.system.matrix, common);
    cholmod_factor* factor = cholmod_analyze(matrix, &common);
    cholmod_factorize(matrix, factor, &common);
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factor, right, &common);
    benchmark::DoNotOptimize(solution->x);
    cholmod_free_dense(&solution, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
  }
  cholmod_free_dense(&right, &common);
  cholmod_finish(&common);
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

BENCHMARK_CAPTURE(factor, membrane, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(bare_cholmod, membrane, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(whole_solve, membrane, membrane)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(factor, elastic_block, elastic_block)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(bare_cholmod, elastic_block, elastic_block)->Apply(sizes<128, 1024>);
BENCHMARK_CAPTURE(whole_solve, elastic_block, elastic_block)->Apply(sizes<128, 1024>);

}  // namespace
}  // namespace signorini
