#include "server/jobs/run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>

#include "progress/memory_meter.hpp"
#include "run/study.hpp"
#include "server/failure.hpp"
#include "server/jobs/kept_operators.hpp"
#include "solve.hpp"

namespace signorini::server {
namespace {

ProblemDetails details_of(const Summary& summary) {
  switch (summary.outcome) {
    case Outcome::cancelled:
      return {"cancelled", "The solve was cancelled", summary.advice};
    case Outcome::tolerance_not_met:
      return {"tolerance-not-met", "The error bound does not meet the tolerance", summary.advice};
    case Outcome::stalled:
      return {"stalled", "The method stopped before it had an answer", summary.advice};
    case Outcome::diverged:
      return {"diverged", "The method did not converge", summary.advice};
    case Outcome::time_limit:
      return {"time-limit", "Not all was done in time", summary.advice};
    default:
      return {"not-converged", "The method did not converge", summary.advice};
  }
}

JobStatus status_of(Outcome outcome) {
  if (outcome == Outcome::converged) return JobStatus::succeeded;
  return outcome == Outcome::cancelled ? JobStatus::cancelled : JobStatus::failed;
}

Ending failed(const std::exception_ptr& error, const LiveSolve& live) {
  Ending ending;
  ending.status = JobStatus::failed;
  ending.error = describe(error).details;
  ending.history = std::make_shared<const std::vector<Iteration>>(live.history());
  return ending;
}

ProblemDetails beyond_its_memory(double bytes) {
  return {"memory-exceeded", "The solve needed more memory than there is for it",
          "It was ended when it was to take more than " + std::to_string(std::llround(bytes / 1e6)) +
              " MB, which is what the limit of the service (--max-memory) and the other solves leave. Take a "
              "coarser mesh or the nonconforming scheme."};
}

ProblemDetails incomplete(const std::vector<StudyRow>& study) {
  const auto is_solved = [](const StudyRow& row) { return row.error.empty(); };
  const auto first = std::ranges::find_if_not(study, is_solved);
  const auto failures = std::count_if(first, study.end(), std::not_fn(is_solved));
  return {"study-incomplete", "Not every run of the study was solved",
          std::to_string(failures) + " of " + std::to_string(study.size()) +
              " rows have no solution, first " + first->error};
}

ProblemDetails incomplete(const std::vector<SweepEntry>& sweep) {
  const auto first = std::ranges::find_if_not(sweep, is_solved);
  const auto failures =
      std::count_if(first, sweep.end(), [](const auto& entry) { return !is_solved(entry); });
  return {"sweep-incomplete", "Not every entry of the sweep was solved",
          std::to_string(failures) + " of " + std::to_string(sweep.size()) +
              " entries have no converged solution, first /sweep/" + std::to_string(first - sweep.begin()) +
              ": " + (first->error.empty() ? first->advice : first->error)};
}

/// The time limit of a chunk is that of the whole.
double seconds_before(const Claim& claim) {
  if (!claim.job.chunk) return 0;
  return std::chrono::duration<double>(*claim.job.started - claim.job.created).count();
}

}  // namespace

Solution solve_request(const api::Request& request, Observer& observer, OperatorCache& operators,
                       IdleCores& cores) {
  const IdleCores::Solve occupied(cores);
  const MemoryMeter memory;
  Settings settings = request.settings;
  settings.executor = &cores;
  settings.threads = cores.threads();
  Solution solution = solve(request.problem, request.sweep, settings, observer, operators);
  if (request.study && observer.keep_going()) {
    settings.spent += solution.summary.timings.total;
    solution.study = run_study(request.problem, *request.study, settings, observer);
  }
  solution.summary.peak_memory_bytes = memory.peak();
  return solution;
}

Ending ending_of(Solution solution) {
  const auto shared = std::make_shared<const Solution>(std::move(solution));
  Ending ending;
  ending.status = status_of(shared->summary.outcome);
  if (ending.status != JobStatus::succeeded) {
    ending.error = details_of(shared->summary);
  } else if (!std::ranges::all_of(shared->sweep, is_solved)) {
    ending.status = JobStatus::failed;
    ending.error = incomplete(shared->sweep);
  } else if (!std::ranges::all_of(shared->study, &std::string::empty, &StudyRow::error)) {
    ending.status = JobStatus::failed;
    ending.error = incomplete(shared->study);
  }
  ending.solution = shared;
  ending.history = std::shared_ptr<const std::vector<Iteration>>(shared, &shared->history);
  return ending;
}

Ending run(const Claim& claim, const SolveFunction& solve, LiveSolve& live, double max_memory,
           Factorization by, Helpers* helpers) {
  if (!claim.problem) return damaged_ending("problem");
  try {
    const MemoryLimit limit(max_memory);
    const auto begin = std::chrono::steady_clock::now();
    api::Request request = api::parse_request(*claim.problem, &live);
    request.problem.operator_key = operator_key_of(claim.job.owner, request.problem.operator_key);
    request.settings.factorization = by;
    request.settings.helpers = helpers;
    request.settings.entries_alone = claim.job.chunk.has_value();
    request.settings.spent = seconds_before(claim) +
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return ending_of(solve(request, live));
  } catch (const Cancelled&) {
    Ending ending = failed(std::current_exception(), live);
    ending.status = JobStatus::cancelled;
    return ending;
  } catch (...) {
    Ending ending = failed(std::current_exception(), live);
    if (MemoryLimit::was_met()) ending.error = beyond_its_memory(max_memory);
    return ending;
  }
}

}  // namespace signorini::server
