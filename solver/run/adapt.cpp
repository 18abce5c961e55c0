#include "adapt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "certify/mark.hpp"
#include "condensed_problem.hpp"
#include "data_check.hpp"
#include "estimate.hpp"
#include "mesh/bisect.hpp"
#include "requested_mesh.hpp"

namespace signorini {
namespace {

/// How many times as many triangles a level has, at most, as the one before.
constexpr double kLargestGrowth = 1.5;

std::string in_words(double number) {
  if (!std::isfinite(number)) return "infinite";
  std::ostringstream text;
  text.precision(3);
  text << number;
  return text.str();
}

/// The answers of the finest level so far and of the one with the smallest relative bound, and the records of
/// all.
class Levels {
 public:
  Levels(const Problem& problem, Progress& progress)
      : problem_(problem), goal_(*problem.mesh.adaptive), progress_(progress) {}

  bool empty() const { return levels_.empty(); }
  /// To be asked for once there is one.
  const Solution& finest() const { return *finest_; }
  bool meets_tolerance() const {
    return measures_.back() <= goal_.tolerance ||
           is_at_rest(problem_, *finest_, *finest_->summary.error_bound);
  }
  /// By which the next mesh is made.
  const Eigen::VectorXd& shares() const {
    const EnclosedQuantity* quantity = goal_quantity(finest_->summary);
    const bool has_shares = quantity && quantity->is_bounded() && quantity->shares.sum() > 0;
    return has_shares ? quantity->shares : finest_->error_squares;
  }

  void add(Solution solution) {
    const Summary& summary = solution.summary;
    const Unknowns& n = summary.unknowns;
    measures_.push_back(measure(summary));
    levels_.push_back(
        progress_.refined({static_cast<int>(levels_.size()) + 1, static_cast<int>(summary.triangles),
                           static_cast<int>(n.stress + n.displacement + n.contact + n.rotation),
                           summary.error_bound->value, summary.error_bound->relative, summary.iterations, 0},
                          solution));
    fields_.push_back({levels_.back().number, solution.mesh->points, solution.mesh->triangles,
                       solution.displacement_at_points, solution.error_squares});
    history_.insert(history_.end(), solution.history.begin(), solution.history.end());
    finest_ = std::make_shared<Solution>(std::move(solution));
    if (best_level_ < 0 || measures_.back() < measures_[best_level_]) {
      best_ = finest_;
      best_level_ = static_cast<int>(levels_.size()) - 1;
    }
  }

  /// Whether four times the triangles have not lowered the bound, once it tells that there is a solution to
  /// be seen: on the coarsest meshes it may rise before it falls.
  bool stagnate() const {
    for (std::size_t i = 0; i < levels_.size(); ++i)
      if (4 * levels_[i].triangles <= levels_.back().triangles && measures_[i] < 1 &&
          measures_[i] <= measures_.back())
        return true;
    return false;
  }

  /// How many times as many triangles the next level should have: half as many again, or less where the rate
  /// of the last two levels lets expect that this meets the tolerance.
  double growth() const {
    constexpr double margin = 1.03;
    if (levels_.size() < 2) return kLargestGrowth;
    const Level &last = levels_.back(), &before = levels_[levels_.size() - 2];
    const double measure = measures_.back(), measure_before = measures_[measures_.size() - 2];
    const double rate =
        std::log(measure_before / measure) / std::log(static_cast<double>(last.triangles) / before.triangles);
    return rate > 0 && std::isfinite(rate)
               ? std::min(kLargestGrowth, margin * std::pow(measure / goal_.tolerance, 1 / rate))
               : kLargestGrowth;
  }

  Solution end(Outcome outcome, std::string advice = {}) {
    Summary& summary = best_->summary;
    summary.outcome = outcome;
    summary.advice = std::move(advice);
    summary.iterations = static_cast<int>(history_.size());
    summary.timings = timings(progress_);
    summary.levels = std::move(levels_);
    best_->history = std::move(history_);
    std::erase_if(fields_, [&](const LevelFields& own) { return own.number == best_level_ + 1; });
    best_->levels = std::move(fields_);
    return std::move(*best_);
  }

  /// The best level, or the one that has no bound to refine the mesh by if it is the first.
  Solution end_without_bound(Solution solution) {
    const std::string why = solution.summary.notes.back();
    const bool is_late = solution.summary.outcome == Outcome::time_limit;
    if (!empty())
      return end_above_tolerance(is_late ? Outcome::time_limit : Outcome::tolerance_not_met,
                                 "on the next mesh " + why);
    if (!is_late) {
      solution.summary.outcome = Outcome::tolerance_not_met;
      solution.summary.advice = why + "; the mesh was not refined";
    }
    return solution;
  }

  /// The best level as an answer that does not meet the tolerance.
  Solution end_above_tolerance(Outcome outcome, const std::string& why) {
    const std::string what = goal_.quantity.empty()
                                 ? "the relative error bound"
                                 : "the relative width of the interval of " + goal_.quantity;
    return end(outcome, what + " is " + measure_and_triangles(best_level_) + of_best_level() + ", and " +
                            in_words(goal_.tolerance) + " was asked for; " + why);
  }

 private:
  const EnclosedQuantity* goal_quantity(const Summary& summary) const {
    const auto found = std::ranges::find(summary.quantities, goal_.quantity, &EnclosedQuantity::name);
    return found == summary.quantities.end() ? nullptr : &*found;
  }

  /// What the tolerance is for; infinite if there is no interval.
  double measure(const Summary& summary) const {
    if (goal_.quantity.empty()) return summary.error_bound->relative;
    const EnclosedQuantity* quantity = goal_quantity(summary);
    return quantity && quantity->is_bounded() ? quantity->relative_width()
                                              : std::numeric_limits<double>::infinity();
  }

  std::string measure_and_triangles(std::size_t level) const {
    return in_words(measures_[level]) + " with " + std::to_string(levels_[level].triangles) + " triangles";
  }

  /// Nothing if it is the last one.
  std::string of_best_level() const {
    const Level& best = levels_[best_level_];
    const Level& last = levels_.back();
    if (best.number == last.number) return "";
    return " on level " + std::to_string(best.number) + ", the best of " + std::to_string(last.number) +
           ", while the last one has " + measure_and_triangles(levels_.size() - 1);
  }

  const Problem& problem_;
  const Adaptive& goal_;
  Progress& progress_;
  std::shared_ptr<Solution> finest_, best_;  // often the same
  int best_level_ = -1;
  std::vector<Level> levels_;
  std::vector<double> measures_;  ///< what the tolerance is for, an entry a level
  std::vector<LevelFields> fields_;
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

Solution solve_level(const Problem& problem, const std::shared_ptr<const Mesh>& mesh, const Levels& coarser,
                     const Settings& settings, Progress& progress) {
  CondensedProblem condensed(problem, mesh, settings.factorization, progress);
  if (coarser.empty()) return condensed.solve(settings, progress, {});
  return condensed.solve(settings, progress,
                         clearance_near(coarser.finest().contact, condensed.discretization()));
}

std::shared_ptr<const Mesh> first_mesh(const Problem& problem, Progress& progress) {
  const Mesh mesh = *requested_mesh(problem, progress);
  require_room(*problem.mesh.adaptive, static_cast<std::int64_t>(mesh.triangles.size()));
  require_sound_data(problem, mesh, progress);
  return std::make_shared<const Mesh>(with_longest_edges_first(mesh));
}

/// The shares of the parts of triangles: a part in n of a triangle has that in n² of its square, as where the
/// error is h. Where it falls faster, or near a corner slower, the next level will tell.
Eigen::VectorXd foreseen(const Eigen::VectorXd& shares, const std::vector<int>& parents) {
  Eigen::VectorXd parts = Eigen::VectorXd::Zero(shares.size()), own(parents.size());
  for (const int parent : parents) ++parts[parent];
  for (std::size_t t = 0; t < parents.size(); ++t)
    own[static_cast<Eigen::Index>(t)] = shares[parents[t]] / (parts[parents[t]] * parts[parents[t]]);
  return own;
}

/// The largest shares in the square of the bound are refined, as far as they are foreseen to fall, until the
/// square will have fallen to less than a third or the triangles have grown so many times, or would be too
/// many. To mark little and often grades the mesh as finely as many levels would, for the price of few.
std::shared_ptr<const Mesh> finer_mesh(Mesh mesh, Eigen::VectorXd shares, double growth, std::size_t most,
                                       Progress& progress) {
  constexpr double fall = 0.3;
  const double enough = growth * static_cast<double>(mesh.triangles.size()), little = fall * shares.sum();
  for (bool first = true;; first = false) {
    // Not to overshoot by a step what the tolerance needs.
    const double bulk = 1.3 * static_cast<double>(mesh.triangles.size()) > enough ? 0.05 : 0.2;
    std::vector<int> parents;
    Mesh finer = bisect(mesh, mark(shares, bulk), parents, &progress);
    if (!first && finer.triangles.size() > most) break;
    shares = foreseen(shares, parents);
    mesh = std::move(finer);
    if (static_cast<double>(mesh.triangles.size()) >= enough || shares.sum() <= little) break;
  }
  return std::make_shared<const Mesh>(std::move(mesh));
}

Solution refine_until_met(const Problem& problem, const Settings& settings, Levels& levels,
                          Progress& progress) {
  const auto most = static_cast<std::size_t>(problem.mesh.adaptive->max_triangles);
  const double foreseen = estimate(problem, settings.factorization).memory_bytes;
  std::shared_ptr<const Mesh> mesh = first_mesh(problem, progress);
  for (;;) {
    Solution solution = solve_level(problem, mesh, levels, settings, progress);
    const auto [outcome, advice] = std::pair(solution.summary.outcome, solution.summary.advice);
    if (!solution.summary.error_bound) return levels.end_without_bound(std::move(solution));
    if (outcome == Outcome::converged || levels.empty()) levels.add(std::move(solution));
    if (outcome != Outcome::converged) return levels.end_above_tolerance(outcome, advice);
    if (levels.meets_tolerance()) return levels.end(outcome);
    if (levels.stagnate())
      return levels.end_above_tolerance(
          Outcome::tolerance_not_met,
          "four times the triangles have not lowered it: raise mesh.adaptive.tolerance");
    progress.enter(Phase::mesh);
    mesh = finer_mesh(*levels.finest().mesh, levels.shares(), levels.growth(), most, progress);
    if (mesh->triangles.size() == levels.finest().mesh->triangles.size())
      return levels.end_above_tolerance(Outcome::tolerance_not_met,
                                        "no triangle adds to it, so that no finer mesh has less of it");
    if (mesh->triangles.size() > most)
      return levels.end_above_tolerance(Outcome::tolerance_not_met,
                                        "the next mesh would have " + std::to_string(mesh->triangles.size()) +
                                            ": raise mesh.adaptive.max_triangles or its tolerance");
    const double needed = estimate(problem, *mesh, settings.factorization).memory_bytes;
    if (needed > foreseen)
      return levels.end_above_tolerance(
          Outcome::tolerance_not_met,
          "the next mesh, of " + std::to_string(mesh->triangles.size()) + " triangles, would take " +
              in_words(needed / 1e6) + " MB, and for mesh.adaptive.max_triangles " +
              in_words(foreseen / 1e6) + " MB were foreseen: raise that or the tolerance");
  }
}

}  // namespace

Solution adapt(const Problem& problem, const Settings& settings, Progress& progress) {
  Levels levels(problem, progress);
  try {
    return refine_until_met(problem, settings, levels, progress);
  } catch (const Cancelled& cancelled) {
    if (levels.empty()) throw;
    return levels.end_above_tolerance(Outcome::cancelled, cancelled.what());
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
