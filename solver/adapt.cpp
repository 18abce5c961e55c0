#include "adapt.hpp"

#include <algorithm>
#include <sstream>

#include "certify/mark.hpp"
#include "condensed_problem.hpp"
#include "mesh/bisect.hpp"
#include "stable_mesh.hpp"

namespace signorini {
namespace {

std::string in_words(double number) {
  std::ostringstream text;
  text.precision(3);
  text << number;
  return text.str();
}

/// The answer of the finest level so far, and the records of all.
class Levels {
 public:
  Levels(const Adaptive& goal, Progress& progress) : goal_(goal), progress_(progress) {}

  bool empty() const { return levels_.empty(); }
  const Solution& finest() const { return finest_; }
  bool meets_tolerance() const { return levels_.back().relative <= goal_.tolerance; }

  void add(Solution solution) {
    const Summary& summary = solution.summary;
    if (!summary.error_bound)
      throw SolveError("the error bound leaves the range of double precision: choose units closer to 1");
    const Unknowns& n = summary.unknowns;
    levels_.push_back(
        progress_.refined({static_cast<int>(levels_.size()) + 1, static_cast<int>(summary.triangles),
                           static_cast<int>(n.stress + n.displacement + n.contact + n.rotation),
                           summary.error_bound->value, summary.error_bound->relative, summary.iterations, 0},
                          solution));
    history_.insert(history_.end(), solution.history.begin(), solution.history.end());
    finest_ = std::move(solution);
  }

  /// Whether four times the triangles have not lowered the bound.
  bool stagnate() const {
    const Level& last = levels_.back();
    return std::ranges::any_of(levels_, [&](const Level& level) {
      return 4 * level.triangles <= last.triangles && level.relative <= last.relative;
    });
  }

  Solution end(Outcome outcome, std::string advice = {}) {
    Summary& summary = finest_.summary;
    summary.outcome = outcome;
    summary.advice = std::move(advice);
    summary.iterations = static_cast<int>(history_.size());
    summary.timings = timings(progress_);
    summary.levels = std::move(levels_);
    finest_.history = std::move(history_);
    return std::move(finest_);
  }

  /// The finest level as an answer that does not meet the tolerance.
  Solution end_above_tolerance(Outcome outcome, const std::string& why) {
    return end(outcome, "the relative error bound is " + in_words(levels_.back().relative) + " with " +
                            std::to_string(levels_.back().triangles) + " triangles, and " +
                            in_words(goal_.tolerance) + " was asked for; " + why);
  }

 private:
  const Adaptive& goal_;
  Progress& progress_;
  Solution finest_;
  std::vector<Level> levels_;
  std::vector<Iteration> history_;
};

/// For each contact unknown the clearance of the nearest row of its part on the coarser mesh; nothing without
/// one.
Eigen::VectorXd clearance_near(const std::vector<ContactPart>& coarse, const Discretization& fine) {
  if (coarse.empty()) return {};
  Eigen::VectorXd start(fine.clearance.unknowns);
  for (const ClearanceRow& row : fine.clearance.rows) {
    if (row.unknown < 0) continue;
    const auto part = std::ranges::find(coarse, fine.mesh.boundary[row.part].name, &ContactPart::name);
    const auto nearest = std::ranges::min_element(
        part->points, {}, [&](const Point& x) { return (x - row.point).squaredNorm(); });
    start[row.unknown] = part->clearance[nearest - part->points.begin()];
  }
  return start;
}

Solution solve_level(const Problem& problem, const std::shared_ptr<const Mesh>& mesh,
                     const Solution& coarser, const Settings& settings, Progress& progress) {
  CondensedProblem condensed(problem, mesh, progress);
  return condensed.solve(settings, progress, clearance_near(coarser.contact, condensed.discretization()));
}

std::shared_ptr<const Mesh> first_mesh(const Problem& problem, Progress& progress) {
  const Mesh mesh = *requested_mesh(problem, progress);
  const int most = problem.mesh.adaptive->max_triangles;
  if (mesh.triangles.size() > static_cast<std::size_t>(most))
    throw InvalidProblem({{"/mesh/adaptive/max_triangles",
                           "the mesh to start from has " + std::to_string(mesh.triangles.size()) +
                               " triangles already: raise it, or start from a coarser mesh"}});
  return std::make_shared<const Mesh>(with_longest_edges_first(mesh));
}

std::shared_ptr<const Mesh> finer_mesh(const Mesh& asked, const Solution& solution) {
  const std::vector<int> marked = mark(solution.error_squares);
  const bool was_mended = asked.triangles.size() != solution.mesh.triangles.size();
  return std::make_shared<const Mesh>(
      bisect(was_mended ? with_longest_edges_first(solution.mesh) : solution.mesh, marked));
}

Solution refine_until_met(const Problem& problem, const Settings& settings, Levels& levels,
                          Progress& progress) {
  const auto most = static_cast<std::size_t>(problem.mesh.adaptive->max_triangles);
  std::shared_ptr<const Mesh> mesh = first_mesh(problem, progress);
  for (;;) {
    Solution solution = solve_level(problem, mesh, levels.finest(), settings, progress);
    const auto [outcome, advice] = std::pair(solution.summary.outcome, solution.summary.advice);
    if (outcome == Outcome::converged || levels.empty()) levels.add(std::move(solution));
    if (outcome != Outcome::converged) return levels.end_above_tolerance(outcome, advice);
    if (levels.meets_tolerance()) return levels.end(outcome);
    if (levels.stagnate())
      return levels.end_above_tolerance(
          Outcome::tolerance_not_met,
          "four times the triangles have not lowered it: raise mesh.adaptive.tolerance");
    progress.enter(Phase::mesh);
    mesh = finer_mesh(*mesh, levels.finest());
    if (mesh->triangles.size() > most)
      return levels.end_above_tolerance(
          Outcome::tolerance_not_met, "the next mesh would have " + std::to_string(mesh->triangles.size()) +
                                          ": raise mesh.adaptive.max_triangles or its tolerance");
  }
}

}  // namespace

Solution adapt(const Problem& problem, const Settings& settings, Progress& progress) {
  Levels levels(*problem.mesh.adaptive, progress);
  try {
    return refine_until_met(problem, settings, levels, progress);
  } catch (const Cancelled& cancelled) {
    if (levels.empty()) throw;
    return levels.end_above_tolerance(Outcome::cancelled, cancelled.what());
  } catch (const InvalidProblem&) {
    throw;
  } catch (const TimeUp&) {
    if (levels.empty()) throw;
    return levels.end_above_tolerance(Outcome::time_limit,
                                      "the time limit was reached: raise solver.time_limit");
  } catch (const std::runtime_error& failure) {
    if (levels.empty()) throw;
    return levels.end_above_tolerance(Outcome::tolerance_not_met,
                                      std::string("the next mesh could not be solved: ") + failure.what());
  }
}

}  // namespace signorini
