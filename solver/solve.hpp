#pragma once

#include <limits>

#include "contact/operator.hpp"
#include "problem/problem.hpp"
#include "problem/settings.hpp"
#include "problem/study.hpp"
#include "progress/observer.hpp"
#include "result/solution.hpp"

namespace signorini {

/// What a solve will take, told without solving.
struct Estimate {
  std::int64_t triangles = 0;
  Unknowns unknowns;
  std::int64_t system = 0;      ///< unknowns of the SPD system that is factored
  double memory_bytes = 0;      ///< that a solve takes at most; see memory_estimate.hpp
  double paper_form_bytes = 0;  ///< the same by the paper's iteration
  double sweep_bytes = 0;       ///< the same where a sweep uses the factor again, without its entries
  double solution_bytes = 0;    ///< of them, what its solution keeps
  double entry_bytes = 0;       ///< what each entry of a sweep adds
  double kept_bytes = 0;        ///< what a sweep keeps for its quantities
  double helper_bytes = 0;      ///< what each thread of the executor adds
  double seconds = 0;           ///< from a fit to measured solves
};

/// Why a mesh cannot refine itself in the paper's iteration.
inline constexpr const char* paper_form_needs_one_mesh =
    "the paper's iteration has a step that suits one mesh only: leave solver.rho and solver.augmentation "
    "out, "
    "or use active_set";

/// Sizes, exact but for large polygons; memory, as a bound that is at most twice too large for exact sizes;
/// time, roughly. Makes no large mesh. For a mesh that refines itself all of it is for the largest mesh that
/// it may become, and the sizes are rough too.
Estimate estimate(const Problem& problem, Factorization by = Factorization::multifrontal);

/// The same by a method, with so many entries of a sweep.
Estimate for_solve(Estimate estimate, const Settings& settings, std::size_t entries = 0);

/// How often a sweep makes the operator of another material.
std::size_t operators_of(const std::vector<Variation>& sweep);

/// Of all that a request asks for.
struct Estimates {
  Estimate problem;  ///< with its sweep: memory by the material that takes most, all operators' seconds
  std::vector<Estimate> runs;  ///< of its study, in the order in which they are solved

  /// Of them together: the runs are solved one after another beside the problem's solution.
  double memory_bytes() const;
};

/// By a method, with a sweep or a study. The runs end with the one that makes their stress unknowns more than
/// `enough`.
Estimates estimate(const Problem& problem, const std::vector<Variation>& sweep,
                   const std::optional<Study>& study, const Settings& settings,
                   std::int64_t enough = std::numeric_limits<std::int64_t>::max());

/// Every fault of the problem, and where the method cannot do what it asks for.
std::vector<Fault> validate(const Problem& problem, const Settings& settings);

/// Refuses what solve() refuses before it factors: data that only the real mesh shows to be bad, those of the
/// sweep too, and a body that cannot come to rest. Answers in sentences what it leaves to the solve: a large
/// mesh (domain_mesh.hpp), and long formulas. The problem has no fault that validate() sees. Throws
/// InvalidProblem and SolveError.
std::vector<std::string> look_ahead(const Problem& problem, const std::vector<Variation>& sweep = {});

/// Solves Problem 4.1 of the paper for the problem.
///
/// Re-entrant; starts no thread. An iteration that does not converge is no error: the solution says so
/// (`summary.outcome`) and holds the last finite iterate. Throws InvalidProblem (faults of the data,
/// those included that only the real mesh shows), SolveError, and Cancelled if the observer ends it.
///
/// A sweep adds an entry for each variation of the problem's data, solved by the same operator, or one of
/// another material; one that has no solution says why and does not end the others. Cancelled and the time
/// limit are for the whole.
///
/// With a cache, an operator that is kept there under `problem.operator_key` is used again, which spares the
/// mesh, the assembly and the factorisation; else the one that is made is kept there. The paper's form has
/// another matrix and does without.
Solution solve(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
               Observer& observer, OperatorCache& cache);
Solution solve(const Problem& problem, const Settings& settings, Observer& observer, OperatorCache& cache);
Solution solve(const Problem& problem, const Settings& settings, Observer& observer);
Solution solve(const Problem& problem, const Settings& settings = {});

}  // namespace signorini
