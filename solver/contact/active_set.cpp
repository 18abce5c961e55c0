#include "contact/active_set.hpp"

#include <limits>
#include <optional>

#include "contact/residuals.hpp"
#include "system/dense_cholesky.hpp"

namespace signorini {
namespace {

/// Steps without fewer violations before exchanges become single.
constexpr int kPatience = 5;
/// Violations below this multiple of the largest term are rounding.
constexpr double kStateRounding = 1e-13;

using Closed = std::vector<bool>;

/// λ = 0; everything if there is no start.
Closed closed_at(const Eigen::VectorXd& start, Eigen::Index size) {
  Closed closed(size, true);
  for (Eigen::Index i = 0; i < start.size(); ++i) closed[i] = start[i] <= 0;
  return closed;
}

std::vector<int> open_indices(const Closed& closed) {
  std::vector<int> open;
  for (int i = 0; i < static_cast<int>(closed.size()); ++i)
    if (!closed[i]) open.push_back(i);
  return open;
}

/// λ = 0 where closed, p = 0 elsewhere; nothing if the open part of S is singular but for rounding: contact
/// that holds the body alone cannot open everywhere.
std::optional<Eigen::VectorXd> solve_for_open(const ContactComplement& contact, const Closed& closed,
                                              Progress& progress) {
  const std::vector<int> open = open_indices(closed);
  const DenseCholesky factor(contact.s, open, progress);
  double largest = 0;
  for (const int i : open) largest = std::max(largest, contact.s(i, i));
  if (!factor.is_positive_definite() || factor.smallest_pivot() < 10 * kStateRounding * largest)
    return std::nullopt;
  const Eigen::VectorXd found = factor.solve(contact.c(open), progress);
  Eigen::VectorXd clearance = Eigen::VectorXd::Zero(contact.size());
  for (std::size_t k = 0; k < open.size(); ++k) clearance[open[k]] = found[static_cast<Eigen::Index>(k)];
  return clearance;
}

/// A closed unknown that contact lets go of last sets the body free to move at no cost. The first of the open
/// ones that this motion closes; nothing if it closes none.
std::optional<int> first_to_close(const ContactComplement& contact, const Closed& closed,
                                  const Eigen::VectorXd& clearance, int opening, Progress& progress) {
  const std::vector<int> open = open_indices(closed);
  const Eigen::VectorXd motion =
      -DenseCholesky(contact.s, open, progress).solve(contact.s(open, opening), progress);
  std::optional<int> first;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < open.size(); ++k) {
    const double change = motion[static_cast<Eigen::Index>(k)];
    const double way = std::max(0., clearance[open[k]]) / -change;
    if (change < 0 && way < shortest) shortest = way, first = open[k];
  }
  return first;
}

/// Exchanges the violating indices, or the first half of them as often as it takes to keep the open part of
/// S regular, and the last of them for one that closes instead.
Eigen::VectorXd exchange(const ContactComplement& contact, std::vector<int> wrong,
                         const Eigen::VectorXd& clearance, Closed& closed, Progress& progress) {
  for (;; wrong.resize((wrong.size() + 1) / 2)) {
    Closed next = closed;
    for (const int i : wrong) next[i] = !next[i];
    auto found = solve_for_open(contact, next, progress);
    if (!found && wrong.size() > 1) continue;
    if (!found) {
      const auto closing = first_to_close(contact, closed, clearance, wrong[0], progress);
      if (closing) next[*closing] = true;
      found = solve_for_open(contact, next, progress);
    }
    if (!found) throw SingularContact();
    closed = next;
    return *found;
  }
}

std::vector<int> violations(const ContactComplement& contact, const Eigen::VectorXd& clearance,
                            const Eigen::VectorXd& force, const Closed& closed) {
  const double largest_clearance = clearance.lpNorm<Eigen::Infinity>();
  const double largest_force =
      contact.s.diagonal().maxCoeff() * largest_clearance + contact.c.lpNorm<Eigen::Infinity>();
  std::vector<int> found;
  for (int i = 0; i < static_cast<int>(closed.size()); ++i)
    if (closed[i] ? force[i] < -kStateRounding * largest_force
                  : clearance[i] < -kStateRounding * largest_clearance)
      found.push_back(i);
  return found;
}

Iteration record_of(const ContactComplement& contact, const Eigen::VectorXd& last,
                    const Eigen::VectorXd& clearance, const Eigen::VectorXd& force, const Closed& closed) {
  const Eigen::VectorXd pressure = force.cwiseQuotient(contact.weight);
  const double scale = contact.c.cwiseQuotient(contact.weight).lpNorm<Eigen::Infinity>();
  const ContactResiduals residuals = contact_residuals(clearance, pressure, contact.weight, scale);
  Iteration iteration;
  iteration.clearance_change = relative_change(last, clearance);
  iteration.penetration = residuals.penetration;
  iteration.tension = residuals.tension;
  iteration.complementarity = residuals.complementarity;
  iteration.active = static_cast<int>(std::ranges::count(closed, true));
  return iteration;
}

}  // namespace

ContactResult active_set(const ContactComplement& contact, const ActiveSet& settings, Progress& progress,
                         const Eigen::VectorXd& start) {
  Closed closed = closed_at(start, contact.size());
  Eigen::VectorXd clearance = Eigen::VectorXd::Zero(contact.size());
  if (const auto found = solve_for_open(contact, closed, progress))
    clearance = *found;
  else
    closed.assign(closed.size(), true);
  Eigen::VectorXd force = contact.force(clearance, progress);
  std::size_t fewest = closed.size() + 1;
  int patience = kPatience;
  for (std::vector<int> wrong = violations(contact, clearance, force, closed);;
       wrong = violations(contact, clearance, force, closed)) {
    const bool done = wrong.empty() && progress.iterations() > 0;
    if (done) return {clearance.cwiseMax(0), Outcome::converged};
    if (progress.iterations() == settings.max_iterations)
      return {clearance.cwiseMax(0), Outcome::iteration_limit};

    if (wrong.size() < fewest) {
      fewest = wrong.size();
      patience = kPatience;
    } else if (--patience < 0) {
      wrong.resize(1);
    }
    const Eigen::VectorXd last = clearance;
    try {
      clearance = exchange(contact, wrong, last, closed, progress);
      force = contact.force(clearance, progress);
    } catch (const TimeUp&) {
      if (progress.iterations() == 0) throw;
      return {last.cwiseMax(0), Outcome::time_limit};
    }
    if (!progress.record(record_of(contact, last, clearance, force, closed)))
      return {clearance.cwiseMax(0), Outcome::time_limit};
  }
}

}  // namespace signorini
