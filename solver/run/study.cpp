#include "study.hpp"

#include <chrono>
#include <cmath>

#include "fem/quadrature.hpp"
#include "fem/raviart_thomas.hpp"
#include "mesh/domain_mesh.hpp"
#include "progress/progress.hpp"
#include "result/true_errors.hpp"
#include "run/estimate.hpp"
#include "run/inf_sup_check.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

double largest_edge(const Mesh& mesh) {
  double longest = 0;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge)
    longest = std::max(longest, mesh.length(edge));
  return longest;
}

/// Throws SolveError unless all that are known are numbers.
void require_finite(const TrueErrors& errors) {
  for (const auto& error :
       {errors.displacement, errors.stress, errors.energy_norm, errors.energy, errors.total})
    if (error && !std::isfinite(*error))
      throw SolveError(
          "the errors against the exact solution leave the range of double precision: look at `exact`");
}

/// `settings` as they are now.
StudyRow row_of(const Problem& problem, const Study& study, const Settings& settings,
                const Solution& solution, Observer& observer) {
  const Summary& summary = solution.summary;
  StudyRow row;
  row.scheme = solution.scheme;
  row.size = largest_edge(*solution.mesh);
  row.triangles = summary.triangles;
  row.unknowns = summary.unknowns;
  row.energy = summary.energy;
  row.error_bound = summary.error_bound;
  row.quantities = summary.quantities;
  row.errors = true_errors(problem, study.exact, solution, observer);
  require_finite(row.errors);
  if (study.checks_inf_sup) row.inf_sup = inf_sup_in_time(problem, *solution.mesh, settings, observer);
  row.iterations = summary.iterations;
  row.seconds = summary.timings.total;
  return row;
}

StudyRow failed_row(Scheme scheme, const StudyMesh& mesh, const std::string& why) {
  StudyRow row;
  row.scheme = scheme;
  row.error = mesh.name + ": " + why;
  return row;
}

Settings after(double seconds, Settings settings) {
  settings.spent += seconds;
  return settings;
}

/// One solve of a study. Shows the observer of the whole its phases and levels, and makes a row of each
/// level.
class Run : public Observer {
 public:
  Run(Problem problem, const Study& study, const Settings& settings, Observer& whole)
      : problem_(std::move(problem)), study_(study), settings_(settings), whole_(whole) {}

  void entered(Phase phase) override { whole_.entered(phase); }
  bool keep_going() override { return whole_.keep_going(); }

  void refined(const Level& level, const Solution& solution) override {
    whole_.refined(level, solution);
    if (solution.summary.outcome != Outcome::converged) return;
    const Stopwatch aside;
    StudyRow row = row_of(problem_, study_, settings_now(), solution, whole_);
    row.level = level.number;
    row.seconds = level.seconds - aside_;
    rows_.push_back(std::move(row));
    aside_ += aside.seconds();
  }

  /// Adds its rows; the last one says so if the solve did not reach its end.
  void add_to(std::vector<StudyRow>& rows, const StudyMesh& mesh) {
    std::string failure;
    try {
      const Solution solution = solve(problem_, settings_, *this);
      if (!whole_.keep_going()) throw Cancelled();
      failure = solution.summary.advice;
      if (failure.empty() && !problem_.mesh.adaptive)
        rows_.push_back(row_of(problem_, study_, settings_now(), solution, whole_));
    } catch (const SolveError& unsolvable) {
      failure = unsolvable.what();
    } catch (const InvalidProblem& only_here) {
      failure = only_here.what();
    }
    std::ranges::move(rows_, std::back_inserter(rows));
    if (!failure.empty()) rows.push_back(failed_row(problem_.scheme, mesh, failure));
  }

 private:
  Settings settings_now() const { return after(watch_.seconds(), settings_); }

  const Problem problem_;
  const Study& study_;
  const Settings& settings_;
  Observer& whole_;
  const Stopwatch watch_;
  std::vector<StudyRow> rows_;
  double aside_ = 0;  ///< seconds that the true errors and the check took
};

/// A value of the number with the logarithms that a rate is made of.
struct Measured {
  double triangles, value;
};

std::optional<Measured> measured(const StudyRow& row, const RowNumber& number) {
  const auto value = row.error.empty() ? number(row) : std::nullopt;
  if (!value || !(*value > 0)) return std::nullopt;
  return Measured{std::log(static_cast<double>(row.triangles)), std::log(*value)};
}

/// The meshes whose inf-sup constants would take too much.
std::vector<Fault> meshes_too_large_for_inf_sup(const Problem& problem, const Study& study,
                                                const Settings& settings) {
  std::vector<Fault> faults;
  if (!too_large_for_inf_sup(most_stress_unknowns(problem, study))) return faults;
  const std::vector<Estimate> runs = estimate(problem, {}, study, settings).runs;
  for (std::size_t i = 0; i < study.meshes.size(); ++i) {
    std::int64_t most = 0;
    for (std::size_t run = i; run < runs.size(); run += study.meshes.size())
      most = std::max(most, runs[run].unknowns.stress);
    if (const auto fault = too_large_for_inf_sup(most)) faults.push_back({study.meshes[i].name, *fault});
  }
  return faults;
}

}  // namespace

std::vector<StudyRow> run_study(const Problem& problem, const Study& study, const Settings& settings,
                                Observer& observer) {
  const Stopwatch watch;
  const std::size_t count = study.schemes.size() * study.meshes.size();
  std::size_t done = 0;
  std::vector<StudyRow> rows;
  for (const Scheme scheme : study.schemes)
    for (const StudyMesh& mesh : study.meshes) {
      const Settings now = after(watch.seconds(), settings);
      if (now.time_limit && *now.time_limit <= now.spent)
        rows.push_back(failed_row(scheme, mesh,
                                  "the time limit for the whole study was reached before: raise "
                                  "solver.time_limit"));
      else
        Run(run_of(problem, mesh, scheme), study, now, observer).add_to(rows, mesh);
      observer.studied(++done, count);
    }
  return rows;
}

Problem run_of(const Problem& problem, const StudyMesh& mesh, Scheme scheme) {
  Problem run = problem;
  run.mesh = mesh.request;
  run.scheme = scheme;
  run.operator_key.clear();
  return run;
}

std::vector<Fault> validate(const Problem& problem, const Study& study, const Settings& settings) {
  std::vector<Fault> faults;
  for (const StudyMesh& mesh : study.meshes) {
    for (Fault& fault : validate_request(problem.domain, mesh.request))
      faults.push_back({mesh.name, fault.detail});
    if (mesh.request.adaptive && std::holds_alternative<PaperUzawa>(settings.method))
      faults.push_back({mesh.name, paper_form_needs_one_mesh});
  }
  if (!faults.empty()) return faults;
  if (study.checks_inf_sup) faults = meshes_too_large_for_inf_sup(problem, study, settings);
  const bool has_fields = study.exact.displacement || !study.exact.stress.empty();
  if (!faults.empty() || !has_fields) return faults;
  const std::optional<Mesh> made = make_coarse_mesh(problem.domain);
  if (!made) return faults;
  const Mesh& coarse = *made;
  const auto check = [&](const auto& evaluate, bool on_contact) {
    try {
      for (const BoundaryPart& part : coarse.boundary) {
        if (!on_contact || !condition_on<Contact>(problem, part.name)) continue;
        for (const int edge : part.edges)
          for (const double s : edge_rule().points) {
            const auto& [a, b] = coarse.edges[edge];
            evaluate(Point((1 - s) * coarse.points[a] + s * coarse.points[b]));
          }
      }
      for (int t = 0; t < static_cast<int>(coarse.triangles.size()); ++t) {
        const AffineMap map(coarse.corners(t));
        for (const Point& reference : triangle_rule().points) evaluate(map(reference));
      }
    } catch (const InvalidProblem& invalid) {
      faults.insert(faults.end(), invalid.faults().begin(), invalid.faults().end());
    }
  };
  if (const auto& displacement = study.exact.displacement)
    for (int c = 0; c < displacement->size(); ++c)
      check([&](const Point& x) { (*displacement)(c, x); }, true);
  for (const Field& stress : study.exact.stress) check([&](const Point& x) { stress(x); }, false);
  return faults;
}

std::optional<double> observed_rate(const std::vector<StudyRow>& rows, std::size_t row,
                                    const RowNumber& number) {
  const auto here = measured(rows[row], number);
  if (!here) return std::nullopt;
  for (std::size_t i = row; i-- > 0 && rows[i].scheme == rows[row].scheme;)
    if (const auto before = measured(rows[i], number)) {
      if (before->triangles == here->triangles) return std::nullopt;
      return -2 * (here->value - before->value) / (here->triangles - before->triangles);
    }
  return std::nullopt;
}

std::optional<double> fitted_rate(const std::vector<StudyRow>& rows, Scheme scheme, const RowNumber& number) {
  std::vector<Measured> all;
  Measured mean{0, 0};
  for (const StudyRow& row : rows)
    if (const auto here = row.scheme == scheme ? measured(row, number) : std::nullopt) {
      all.push_back(*here);
      mean.triangles += here->triangles;
      mean.value += here->value;
    }
  mean.triangles /= static_cast<double>(all.size());
  mean.value /= static_cast<double>(all.size());
  double along = 0, spread = 0;
  for (const Measured& here : all) {
    const double step = here.triangles - mean.triangles;
    along += step * (here.value - mean.value);
    spread += step * step;
  }
  if (!(spread > 0)) return std::nullopt;
  return -2 * along / spread;
}

}  // namespace signorini
