#include "solve.hpp"

#include <limits>

#include "progress/memory_meter.hpp"
#include "run/adapt.hpp"
#include "run/certified.hpp"
#include "run/condensed_problem.hpp"
#include "run/data_check.hpp"
#include "run/paper_form.hpp"
#include "run/requested_mesh.hpp"
#include "run/sweep.hpp"

namespace signorini {
namespace {

std::string in_words(const NotPositiveDefinite& failure) {
  return std::string(failure.what()) +
         ": the stiffness varies too strongly over the mesh, or its triangles are too thin; check the "
         "material and its units, and the sizes of the domain";
}

/// Adds an entry for each variation; `solve_one(variation, progress, show)` finds it.
template <typename SolveOne>
void sweep_over(const std::vector<Variation>& sweep, const Settings& settings, Observer& observer,
                const Progress& whole, Solution& solution, const SolveOne& solve_one) {
  SilentObserver within(observer);
  ShowSolution show;
  if (observer.sees_entries())
    show = [&](const Solution& own) { observer.entry(solution.sweep.size(), own); };
  for (const Variation& variation : sweep) {
    Progress progress(within, settings.time_limit, settings.spent + whole.seconds());
    SweepEntry entry;
    try {
      entry = solve_one(variation, progress, show);
    } catch (const SolveError& failure) {
      entry.error = failure.what();
    } catch (const NotPositiveDefinite& failure) {
      entry.error = in_words(failure);
    } catch (const InvalidProblem& invalid) {
      entry.error = invalid.faults().front().where + " " + invalid.faults().front().detail;
    }
    entry.title = variation.title;
    entry.seconds = progress.seconds();
    solution.sweep.push_back(std::move(entry));
    observer.swept(solution.sweep.size(), sweep.size());
  }
}

Solution solve_condensed(const Problem& problem, const std::vector<Variation>& sweep,
                         const Settings& settings, Observer& observer, OperatorCache* cache,
                         Progress& progress) {
  if (problem.operator_key.empty()) cache = nullptr;
  auto used = cache ? cache->find(problem.operator_key) : nullptr;
  const bool keeps = cache && !used;
  Solution solution;
  {
    std::shared_ptr<const Mesh> mesh;
    if (!used) mesh = requested_mesh(problem, progress);
    require_sound_data(problem, used ? used->mesh() : *mesh, progress);
    CondensedProblem condensed = used ? CondensedProblem(problem, used, progress)
                                      : CondensedProblem(problem, mesh, settings.factorization, progress);
    used = condensed.used_operator();
    if (keeps) cache->keep(problem.operator_key, used);
    solution = condensed.solve(settings, progress);
  }
  if (sweep.empty()) used.reset();  // unless the cache has it, too
  add_certified(problem, settings, progress, solution);
  if (sweep.empty()) return solution;
  Sweep entries(problem, std::move(used), settings);
  sweep_over(sweep, settings, observer, progress, solution,
             [&](const Variation& variation, Progress& own, const ShowSolution& show) {
               return entries.solve(variation, own, show);
             });
  return solution;
}

Solution solve_by_method(const Problem& problem, const std::vector<Variation>& sweep,
                         const Settings& settings, Observer& observer, OperatorCache* cache,
                         Progress& progress) {
  if (problem.mesh.adaptive) {
    Solution solution = adapt(problem, settings, progress);
    add_certified(problem, settings, progress, solution);
    return solution;
  }
  if (!std::holds_alternative<PaperUzawa>(settings.method))
    return solve_condensed(problem, sweep, settings, observer, cache, progress);
  Solution solution = solve_paper_form(problem, settings, progress);
  add_certified(problem, settings, progress, solution);
  Problem varied = problem;
  sweep_over(sweep, settings, observer, progress, solution,
             [&](const Variation& variation, Progress& own, const ShowSolution& show) {
               apply(variation, problem, varied);
               if (!show) return entry_of(iterate_paper_form(varied, settings, own));
               Solution shown = solve_paper_form(varied, settings, own);
               show(shown);
               return entry_of(std::move(shown));
             });
  return solution;
}

Solution solve(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
               Observer& observer, OperatorCache* cache) {
  Progress progress(observer, settings.time_limit, settings.spent);
  const MemoryMeter memory;
  progress.enter(Phase::mesh);
  constexpr double all = std::numeric_limits<double>::infinity();
  if (auto faults = validate(problem, settings); !faults.empty()) throw InvalidProblem(std::move(faults));
  if (auto faults = faults_of_sweep(problem, sweep, all, &progress); !faults.empty())
    throw InvalidProblem(std::move(faults));
  try {
    Solution solution = solve_by_method(problem, sweep, settings, observer, cache, progress);
    solution.summary.peak_memory_bytes = memory.peak();
    return solution;
  } catch (const NotPositiveDefinite& failure) {
    throw SolveError(in_words(failure));
  } catch (const OutOfMemory& failure) {
    throw SolveError(std::string(failure.what()) + ": use a coarser mesh or a machine with more memory");
  }
}

}  // namespace

Solution solve(const Problem& problem, const Settings& settings, Observer& observer, OperatorCache& cache) {
  return solve(problem, {}, settings, observer, &cache);
}

Solution solve(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
               Observer& observer, OperatorCache& cache) {
  return solve(problem, sweep, settings, observer, &cache);
}

Solution solve(const Problem& problem, const Settings& settings, Observer& observer) {
  return solve(problem, {}, settings, observer, nullptr);
}

Solution solve(const Problem& problem, const Settings& settings) {
  Observer indifferent;
  return solve(problem, settings, indifferent);
}

}  // namespace signorini
