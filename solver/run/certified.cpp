#include "run/certified.hpp"

#include <algorithm>

#include "certify/reactions/reactions.hpp"
#include "formula/interval.hpp"
#include "result/in_range.hpp"

namespace signorini {
namespace {

/// Each number of a support takes a solve: what so many take is little beside the solution.
constexpr std::size_t kSupports = 16;
/// What the energies of extensions may be too large by, where the stiffness varies.
constexpr double kOfEnergy = 1e-3;

void add_supports(const Discretization& discrete, std::shared_ptr<const ElementTree> tree,
                  const Settings& settings, Progress& progress, const Solution& solution,
                  Certified& certified) {
  const LawOnMesh laws(discrete.problem.material, discrete.mesh, kOfEnergy, progress);
  const Extensions extensions(discrete, laws, settings.factorization, progress, std::move(tree));
  if (extensions.supports().size() > kSupports) {
    certified.unmet.push_back("what supports take is bounded for up to " + std::to_string(kSupports) +
                              " of them: ask for quantities");
    return;
  }
  certified.supports = Reactions(discrete, solution, extensions, progress).all(certified.unmet, progress);
}

/// The support whose pressure a quantity is, times a constant; null if it is another quantity.
const CertifiedSupport* support_of(const Quantity& quantity, const Certified& certified) {
  if (!quantity.has_no_loads() || !quantity.motions.empty() || quantity.weights.size() != 1) return nullptr;
  const std::string& part = quantity.weights.begin()->first;
  if (!quantity.weights.begin()->second.is_constant()) return nullptr;
  const auto found = std::ranges::find_if(certified.supports, [&](const CertifiedSupport& support) {
    return support.pressure_force && support.pressure_force->is_bounded() &&
           support.parts == std::vector{part};
  });
  return found == certified.supports.end() ? nullptr : &*found;
}

/// What its support takes encloses a quantity, too: where the mesh does not see a peak of the gap, that knows
/// of the quantity next to nothing.
void narrow(const Quantity& quantity, const CertifiedSupport& support, EnclosedQuantity& enclosed) {
  const EnclosedNumber& force = *support.pressure_force;
  Interval ends = quantity.weights.begin()->second(Point::Zero()) * Interval(force.lower, force.upper);
  if (enclosed.guaranteed) ends = intersection(ends, {enclosed.lower, enclosed.upper});
  enclosed.lower = ends.lower();
  enclosed.upper = ends.upper();
  enclosed.estimate = estimate_within(enclosed.value, enclosed.lower, enclosed.upper);
  enclosed.guaranteed = true;
  enclosed.unmet.clear();
}

}  // namespace

void add_certified(const Problem& problem, const Settings& settings, Progress& progress, Solution& solution,
                   const Discretization* at_hand, std::shared_ptr<const ElementTree> tree) {
  Summary& summary = solution.summary;
  const std::optional<ErrorBound>& bound = summary.error_bound;
  if (!bound || !bound->guaranteed || summary.outcome == Outcome::cancelled) return;
  const double begin = progress.seconds();
  Certified certified;
  certified.energy = enclosed_number(summary.energy, bound->energy_lower, bound->energy_upper);
  certified.work = bound->work;
  try {
    progress.enter(Phase::certify);
    if (at_hand != nullptr)
      add_supports(*at_hand, std::move(tree), settings, progress, solution, certified);
    else
      add_supports(Discretization(problem, *solution.mesh, &progress), nullptr, settings, progress, solution,
                   certified);
  } catch (const TimeUp&) {
    certified.unmet.push_back(
        "the time limit was reached before it was known what supports take: raise solver.time_limit");
  } catch (const Cancelled& cancelled) {
    // A mesh that refines itself keeps what it has.
    if (!problem.mesh.adaptive) throw;
    summary.outcome = Outcome::cancelled;
    summary.advice = cancelled.what();
    return;
  } catch (const NotPositiveDefinite& failure) {
    certified.unmet.push_back(std::string("it is not known what supports take: ") + failure.what());
  }
  if (!is_in_range(certified)) {
    certified.supports.clear();
    certified.unmet.push_back("what supports take leaves the range of double precision");
  }
  for (std::size_t i = 0; i < summary.quantities.size(); ++i)
    if (const CertifiedSupport* support = support_of(problem.quantities[i], certified))
      narrow(problem.quantities[i], *support, summary.quantities[i]);
  summary.certified = std::move(certified);
  const double seconds = progress.seconds() - begin;
  summary.timings.certify += seconds;
  summary.timings.total += seconds;
}

}  // namespace signorini
