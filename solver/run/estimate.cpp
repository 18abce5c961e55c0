#include "estimate.hpp"

#include <algorithm>
#include <optional>

#include "estimation.hpp"
#include "memory_estimate.hpp"
#include "mesh/mesh_sizes.hpp"
#include "progress/in_parts.hpp"

namespace signorini {

Estimate estimate(const Problem& problem, Factorization by) {
  const PredictedSizes predicted(problem.domain);
  return Estimation(problem, by, &predicted)();
}

Estimate estimate(const Problem& problem, const Mesh& mesh, Factorization by) {
  return Estimation(problem, by, nullptr)(mesh);
}

namespace {

/// As measured, a stress unknown. The paper's problem takes some 200 iterations; how many others take is not
/// known.
double seconds_of_iterations(const PaperUzawa& method, const Estimate& estimate) {
  constexpr double of_unknown = 1e-7;
  constexpr int iterations = 200;
  return of_unknown * static_cast<double>(estimate.unknowns.stress) *
         std::min(iterations, method.max_iterations);
}

/// A mesh of one part has none.
double memory_of_helpers(const Estimate& estimate, const Settings& settings) {
  const std::int64_t others = (estimate.triangles - 1) / kPart;
  return static_cast<double>(std::min<std::int64_t>(settings.threads - 1, others)) * estimate.helper_bytes;
}

}  // namespace

Estimate for_solve(Estimate estimate, const Settings& settings, std::size_t entries) {
  if (entries > 0) estimate.memory_bytes = estimate.sweep_bytes;
  if (const auto* paper = std::get_if<PaperUzawa>(&settings.method)) {
    // Its iterate is there while the discrete solution is certified.
    estimate.memory_bytes =
        std::max(estimate.memory_bytes + estimate.solution_bytes, estimate.paper_form_bytes);
    estimate.seconds += static_cast<double>(1 + entries) * seconds_of_iterations(*paper, estimate);
  }
  estimate.memory_bytes += memory_of_helpers(estimate, settings);
  estimate.memory_bytes += std::visit(
      [](const auto& method) { return memory_of_history(method.max_iterations); }, settings.method);
  // A sweep has a second solution, to which its entries refer, and what they share.
  if (entries > 0)
    estimate.memory_bytes +=
        estimate.solution_bytes + estimate.kept_bytes + static_cast<double>(entries) * estimate.entry_bytes;
  return estimate;
}

std::size_t operators_of(const std::vector<Variation>& sweep) {
  std::size_t count = 0;
  std::string at_hand;
  for (const Variation& variation : sweep) {
    const std::string& key = variation.material_key;
    const bool is_own = !variation.material;
    if (is_own ? !at_hand.empty() : key.empty() || key != at_hand) ++count;
    at_hand = is_own ? "" : key.empty() ? "?" : key;
  }
  return count;
}

namespace {

/// How many entries have the problem's material, and other loads than what is solved before them.
std::size_t other_loads(const Problem& problem, const std::vector<Variation>& sweep) {
  std::size_t count = 0;
  const std::string* last = &problem.load_key;
  for (const Variation& variation : sweep) {
    if (!variation.material && (variation.load_key.empty() || variation.load_key != *last)) ++count;
    last = &variation.load_key;
  }
  return count;
}

/// The problem with those data, of its own and of the entries, that take the most memory: that goes by
/// whether a material, a load or a traction varies in space, and not by how. Nothing if they are its own.
std::optional<Problem> heaviest(const Problem& problem, const std::vector<Variation>& sweep) {
  std::optional<Problem> other;
  const auto made = [&]() -> Problem& { return other ? *other : other.emplace(problem); };
  const auto so_far = [&]() -> const Problem& { return other ? *other : problem; };
  for (const Variation& variation : sweep) {
    if (variation.material && !is_constant(*variation.material) && is_constant(so_far().material))
      made().material = *variation.material;
    if (memory_of_load(variation.body) > memory_of_load(so_far().body)) made().body = variation.body;
    for (const auto& [part, condition] : variation.boundary) {
      if (has_uniform_load(condition)) continue;
      const auto own = so_far().boundary.find(part);
      if (own == so_far().boundary.end() || has_uniform_load(own->second))
        made().boundary.insert_or_assign(part, condition);
    }
  }
  return other;
}

Estimate with_sweep(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
                    const PredictedSizes& predicted) {
  Estimate most = Estimation(problem, settings.factorization, &predicted)();
  // Another material makes an operator. What is left of a solve otherwise is as measured: half of it for
  // other loads, and for quantities, which need the fields; next to nothing for gaps.
  constexpr double of_loads = 0.5, of_gaps = 0.02;
  const std::size_t operators = operators_of(sweep), without = sweep.size() - operators,
                    loads =
                        problem.quantities.empty() ? std::min(without, other_loads(problem, sweep)) : without;
  const double quantities = seconds_of_quantities(problem, static_cast<double>(most.triangles));
  most.seconds = (most.seconds - quantities) *
                     (1 + static_cast<double>(operators) + of_loads * static_cast<double>(loads) +
                      of_gaps * static_cast<double>(without - loads)) +
                 quantities * static_cast<double>(1 + sweep.size());
  if (const std::optional<Problem> varied = heaviest(problem, sweep)) {
    const Estimate with_it = Estimation(*varied, settings.factorization, &predicted)();
    most.sweep_bytes = std::max(most.sweep_bytes, with_it.sweep_bytes);
    most.paper_form_bytes = std::max(most.paper_form_bytes, with_it.paper_form_bytes);
  }
  return for_solve(most, settings, sweep.size());
}

/// Of the inf-sup constant, a stress unknown, as measured.
constexpr double seconds_of_inf_sup = 2.5e-5;

std::vector<Estimate> of_runs(const Problem& problem, const Study& study, Factorization by,
                              const PredictedSizes& predicted, std::int64_t enough) {
  std::vector<Estimate> runs;
  Estimation estimation(problem, by, &predicted);
  for (const Scheme scheme : study.schemes)
    for (const StudyMesh& mesh : study.meshes) {
      Estimate& run = runs.emplace_back(estimation(mesh.request, scheme));
      if (study.checks_inf_sup) {
        const Spaces& spaces = spaces_of(scheme, components(problem.material));
        const double check =
            run.solution_bytes + memory_of_inf_sup(spaces, static_cast<double>(run.triangles));
        run.memory_bytes = std::max(run.memory_bytes, check);
        run.seconds += seconds_of_inf_sup * static_cast<double>(run.unknowns.stress);
      }
      enough -= run.unknowns.stress;
      if (enough < 0) return runs;
    }
  return runs;
}

}  // namespace

std::int64_t most_stress_unknowns(const Problem& problem, const Study& study) {
  const PredictedSizes predicted(problem.domain);
  std::int64_t most = 0;
  for (const StudyMesh& mesh : study.meshes) {
    const MeshSizes sizes = refined(predicted(mesh.request), mesh.request.refine);
    Counts counts{sizes.triangles, sizes.edges, sizes.points};
    if (mesh.request.adaptive) counts = grown(counts, *mesh.request.adaptive);
    for (const Scheme scheme : study.schemes)
      most = std::max(most, stress_unknowns(spaces_of(scheme, components(problem.material)), counts));
  }
  return most;
}

Estimates estimate(const Problem& problem, const std::vector<Variation>& sweep,
                   const std::optional<Study>& study, const Settings& settings, std::int64_t enough) {
  const PredictedSizes predicted(problem.domain);
  Estimates estimates{with_sweep(problem, sweep, settings, predicted), {}};
  if (study) estimates.runs = of_runs(problem, *study, settings.factorization, predicted, enough);
  for (Estimate& run : estimates.runs) run = for_solve(run, settings);
  return estimates;
}

double Estimates::memory_bytes() const {
  double bytes = problem.memory_bytes;
  for (const Estimate& run : runs) bytes = std::max(bytes, problem.solution_bytes + run.memory_bytes);
  return bytes;
}

}  // namespace signorini
