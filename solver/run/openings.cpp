#include "run/openings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/pressure/contact_terms.hpp"
#include "fem/lagrange.hpp"
#include "fem/quadrature.hpp"
#include "run/condensed_problem.hpp"

namespace signorini {
namespace {

const std::string needs_support =
    "an opening is bounded where the body is held without its contacts: fix a part, or ask for a pressure "
    "force";

/// w d in the place of a contact: in which of its two directions, the energy does not tell.
Condition pull(const Contact& contact, const Field& weight, int components) {
  if (components == 1) return Traction{VectorField(weight)};
  if (contact.direction.isZero(0)) return Pressure{weight};
  const Vector d = contact.unit_direction(Vector::Zero());
  const auto times = [&](double factor) { return Field(0, weight.name()).plus(factor, weight); };
  return Traction{VectorField(times(d.x()), times(d.y()))};
}

}  // namespace

Problem pulled_body(const Quantity& quantity, Problem problem) {
  problem.body = {};
  problem.quantities.clear();
  problem.mesh.adaptive.reset();
  problem.operator_key.clear();
  problem.load_key.clear();
  for (auto& [part, condition] : problem.boundary) {
    const auto* contact = std::get_if<Contact>(&condition);
    const auto weight = quantity.openings.find(part);
    if (std::holds_alternative<Fixed>(condition))
      condition = Fixed{};
    else if (contact && weight != quantity.openings.end())
      condition = pull(*contact, weight->second, components(problem.material));
    else if (!std::holds_alternative<Roller>(condition))
      condition = Traction{};
  }
  return problem;
}

const Field* weight_on(const std::map<std::string, Field>& weights, const Discretization& discrete,
                       const ContactEdge& contact) {
  const int part = discrete.clearance.rows[contact.rows[0]].part;
  const auto found = weights.find(discrete.mesh.boundary[part].name);
  return found == weights.end() ? nullptr : &found->second;
}

Pull pull_of(const Quantity& quantity, const Discretization& discrete, Factorization by, Progress& progress) {
  const Problem problem = pulled_body(quantity, discrete.problem);
  constexpr double anything = std::numeric_limits<double>::infinity();
  try {
    CondensedProblem condensed(problem, std::make_shared<const Mesh>(discrete.mesh), by, progress);
    const Settings exactly{ActiveSet{}, std::nullopt, 0, by};
    const Solution solution = condensed.solve(exactly, progress);
    if (const auto& bound = solution.summary.error_bound)
      return {std::sqrt(2 * std::max(0., -bound->energy_lower)), bound->unmet};
    progress.check();  // whether it had no time
    return {anything, {"nothing bounds the energy of the body that the weight pulls"}};
  } catch (const TimeUp&) {
    throw;
  } catch (const SolveError& failure) {
    return {anything, {failure.what()}};
  } catch (const NotPositiveDefinite&) {
    return {anything, {needs_support}};
  } catch (const InvalidProblem&) {
    return {anything, {needs_support}};
  }
}

double opening_of(const Quantity& quantity, const Discretization& discrete,
                  const Eigen::VectorXd& clearance) {
  double sum = 0;
  for (const ContactEdge& contact : discrete.clearance.edges)
    if (const Field* weight = weight_on(quantity.openings, discrete, contact)) {
      const EdgeLine line(discrete.mesh, contact.edge);
      const auto at = [&](int row) { return clearance[row] + discrete.clearance.rows[row].beyond; };
      for (int q = 0; q < EdgeRule::size; ++q) {
        const double s = edge_rule().points[q];
        const double lambda = (1 - s) * at(contact.rows[0]) + s * at(contact.rows[1]);
        sum += edge_rule().weights[q] * discrete.mesh.length(contact.edge) * line.value(*weight, s) * lambda;
      }
    }
  return sum;
}

std::array<double, 2> enclose_opening(const Quantity& quantity, const CertifiedSolution& base, double radius,
                                      const Pull& pull, Progress& progress, std::vector<std::string>& unmet) {
  const Discretization& discrete = base.discrete;
  unmet.insert(unmet.end(), pull.unmet.begin(), pull.unmet.end());
  const double off = radius * pull.norm;
  ContactTerms::Work all;
  CellBudget budget{ContactTerms::kCells, &progress};
  const int edges = static_cast<int>(discrete.clearance.edges.size());
  for (int i = 0; i < edges; ++i)
    if (const Field* weight = weight_on(quantity.openings, discrete, discrete.clearance.edges[i]))
      budget.share(edges - i, [&](CellBudget& own) {
        const auto [value, known] =
            ContactTerms(discrete, base.pair.v, i, own).opening(*weight, base.pair.v, own);
        all.value += value;
        all.radius += known;
      });
  if (!std::isfinite(all.radius))
    unmet.push_back("the gap or the weight is not known to be finite where the opening is asked for");
  return {all.value - all.radius - off, all.value + all.radius + off};
}

}  // namespace signorini
