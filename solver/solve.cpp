#include "solve.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "progress/helpers.hpp"
#include "progress/memory_meter.hpp"
#include "progress/overflow.hpp"
#include "result/in_range.hpp"
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

/// Solves variations by the paper's iteration, each by itself.
class PaperSweep {
 public:
  PaperSweep(const Problem& problem, const Settings& settings)
      : problem_(problem), settings_(settings), varied_(problem) {}

  SweepEntry solve(const Variation& variation, Progress& progress, const ShowSolution& show) {
    apply(variation, problem_, varied_);
    if (!show) return entry_of(iterate_paper_form(varied_, settings_, progress));
    Solution shown = solve_paper_form(varied_, settings_, progress);
    show(shown);
    return entry_of(std::move(shown));
  }

  void begin_anew() {}

  static std::vector<std::size_t> starts(const std::vector<Variation>& sweep, std::size_t first, Progress&) {
    std::vector<std::size_t> all(sweep.size() - first);
    std::iota(all.begin(), all.end(), first);
    return all;
  }

 private:
  const Problem& problem_;
  const Settings& settings_;
  Problem varied_;
};

/// Adds an entry for each variation to the solution.
template <typename Entries>
class SweepOver {
 public:
  SweepOver(Entries entries, const std::vector<Variation>& sweep, const Settings& settings,
            Observer& observer, Progress& whole)
      : entries_(std::move(entries)),
        sweep_(sweep),
        settings_(settings),
        observer_(observer),
        within_(observer),
        whole_(whole) {}

  void solve(Solution& solution) {
    for (std::size_t i = 0; i < sweep_.size(); ++i) {
      const auto starts = [&] { return entries_.starts(sweep_, i, whole_); };
      if (settings_.helpers != nullptr && settings_.helpers->join(i, starts) == i) {
        std::ranges::move(settings_.helpers->solve(i, here()), std::back_inserter(solution.sweep));
        return;
      }
      solution.sweep.push_back(entry(i));
      observer_.swept(i + 1, sweep_.size());
    }
  }

 private:
  SolveEntries here() {
    return [this](std::size_t first, std::size_t count, const auto& told) {
      entries_.begin_anew();
      std::vector<SweepEntry> found;
      while (found.size() < count) {
        found.push_back(entry(first + found.size()));
        told(found.size());
      }
      return found;
    };
  }

  SweepEntry entry(std::size_t number) {
    const Variation& variation = sweep_[number];
    Progress progress(within_, settings_.time_limit, settings_.spent + whole_.seconds(), settings_.executor);
    ShowSolution show;
    if (observer_.sees_entries()) show = [&](const Solution& own) { observer_.entry(number, own); };
    SweepEntry entry;
    try {
      progress.check();  // of thousands that come too late none begins
      entry = entries_.solve(variation, progress, show);
      if (!is_in_range(entry)) throw Overflow();
    } catch (const SolveError& failure) {
      entry = {};
      entry.error = failure.what();
    } catch (const NotPositiveDefinite& failure) {
      entry.error = in_words(failure);
    } catch (const InvalidProblem& invalid) {
      entry.error = invalid.faults().front().where + " " + invalid.faults().front().detail;
    }
    entry.title = variation.title;
    entry.seconds = progress.seconds();
    return entry;
  }

  Entries entries_;
  const std::vector<Variation>& sweep_;
  const Settings& settings_;
  Observer& observer_;
  SilentObserver within_;
  Progress& whole_;
};

Solution solve_condensed(const Problem& problem, const std::vector<Variation>& sweep,
                         const Settings& settings, Observer& observer, OperatorCache* cache,
                         Progress& progress) {
  if (problem.operator_key.empty()) cache = nullptr;
  auto used = cache ? cache->find(problem.operator_key) : nullptr;
  const bool keeps = cache && !used;
  if (used) used = on_loan(std::move(used), MadeBy::another);
  Solution solution;
  const std::shared_ptr<const Mesh> mesh = used ? used->shared_mesh() : requested_mesh(problem, progress);
  require_sound_data(problem, *mesh, progress);
  std::unique_ptr<const Discretization> discretization;
  std::shared_ptr<const ElementTree> tree;
  {
    CondensedProblem condensed = used ? CondensedProblem(problem, std::move(used), progress)
                                      : CondensedProblem(problem, mesh, settings.factorization, progress);
    if (keeps && cache->keep(problem.operator_key, condensed.used_operator()))
      condensed.borrow(on_loan(condensed.used_operator(), MadeBy::this_solve));
    used = sweep.empty() ? nullptr : condensed.used_operator();
    tree = condensed.used_operator()->factor().tree();
    if (!settings.entries_alone) solution = condensed.solve(settings, progress);
    discretization = condensed.take_discretization();
  }
  if (!settings.entries_alone)
    add_certified(problem, settings, progress, solution, discretization.get(), tree);
  discretization.reset();
  if (!sweep.empty())
    SweepOver(Sweep(problem, std::move(used), settings), sweep, settings, observer, progress).solve(solution);
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
  Solution solution;
  if (!settings.entries_alone) {
    solution = solve_paper_form(problem, settings, progress);
    add_certified(problem, settings, progress, solution);
  }
  SweepOver(PaperSweep(problem, settings), sweep, settings, observer, progress).solve(solution);
  return solution;
}

Solution solve(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
               Observer& observer, OperatorCache* cache) {
  Progress progress(observer, settings.time_limit, settings.spent, settings.executor);
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
