#include "certify/certificate.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "certify/data/carried_loads.hpp"
#include "certify/energy_norm.hpp"
#include "certify/gap_estimate.hpp"
#include "certify/patches/patch_pairs.hpp"
#include "certify/totals.hpp"
#include "certify/unmet.hpp"

namespace signorini {
namespace {

/// What the rules for a varying law may miss, beside the square of the bound's largest part.
constexpr double kOfGap = 2e-5;

/// What carried loads may add to the bound before they are worth factorisations.
constexpr double kLittle = 0.01;

/// Where the pressure of the conforming scheme is not admissible, finer pairs stand for the given one. A
/// patch that cannot be solved, because nothing holds it, leaves the pair as it is. A mesh that refines
/// itself is fine in these places already: there the bound would fall by an eighth, for more than its solves
/// take. Answers what is not known of the loads on the patches.
LoadsBroughtBack add_patches(const Discretization& discrete, const Solution& solution,
                             const AdmissiblePair& pair, double tolerance, Owners& owners, Totals& totals,
                             Progress& progress) {
  LoadsBroughtBack back{0, std::vector<double>(discrete.triangles())};
  const bool is_admissible = discrete.spaces().order == 0 || pair.pressure.stream_function_at_points.empty();
  if (is_admissible || discrete.problem.mesh.adaptive) return back;
  SilentObserver silent(progress.observer());
  Progress within(silent, progress);
  for (Patch& patch : patches_where_pressure_changes(discrete, pair.pressure)) {
    try {
      const PatchPairs pairs(discrete, solution.stress, pair, std::move(patch), within);
      const std::vector<int>& parents = pairs.patch().parents;
      const LawOnMesh laws(discrete.problem.material, *pairs.patch().mesh, tolerance, within);
      if (!pairs.are_admissible() || !laws.unmet().empty()) continue;
      const LoadsBroughtBack own =
          bring_back(pairs.discretization(), laws, pairs.first().pressure, parents, discrete.triangles());
      totals.add<1>(pairs.discretization(), laws, pairs.first(), MembraneSums(pairs), parents, within,
                    &pairs.second());
      for (const int t : parents) owners[t] = -1;
      back.square += own.square;
      for (int t = 0; t < discrete.triangles(); ++t) back.forces[t] += own.forces[t];
    } catch (const TimeUp&) {
      throw;
    } catch (const std::runtime_error&) {
      continue;
    }
  }
  return back;
}

std::vector<EdgePressure> pressure_where(const Owners& owners, const Discretization& discrete,
                                         const ContactPressure& pressure) {
  std::vector<EdgePressure> all;
  for (std::size_t i = 0; i < pressure.at_ends.size(); ++i) {
    const EdgePressure own = pressure.on(discrete, static_cast<int>(i));
    const bool is_owned = owners[discrete.mesh.edge_triangles[own.edge][0]] >= 0;
    if (is_owned && (own.at_ends[0] != 0 || own.at_ends[1] != 0)) all.push_back(own);
  }
  return all;
}

/// Products of numbers so small have lost digits, or are 0.
bool are_lost(const Totals& totals, const Eigen::MatrixXd& stress) {
  constexpr double least = std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
  const double energies = totals.all.strain + totals.all.stress + totals.work;
  return energies < least && !stress.isZero(0);
}

/// Fixed values and gaps are zero, and known to be.
bool supports_rest(const Problem& problem) {
  const auto is_zero = [](const Field& field) { return field.is_constant() && field(Point::Zero()) == 0; };
  return std::ranges::all_of(problem.boundary, [&](const auto& own) {
    if (const auto* fixed = std::get_if<Fixed>(&own.second))
      return std::ranges::all_of(fixed->value.fields(), is_zero);
    const auto* contact = std::get_if<Contact>(&own.second);
    return !contact || is_zero(contact->gap);
  });
}

/// The data are not what they should be in a point that the discrete problem does not ask.
Certificate without_bound(const std::vector<Fault>& faults) {
  Certificate certificate;
  certificate.bound.value = std::numeric_limits<double>::infinity();
  for (const Fault& fault : faults) certificate.bound.unmet.push_back(fault.where + " " + fault.detail);
  return certificate;
}

Certificate certify_sound_data(const Discretization& discrete, const Solution& solution,
                               const Eigen::VectorXd& coupling, ShapeNorms& norms, Progress& progress) {
  AdmissiblePair pair = admissible_pair(discrete, solution, coupling, progress);
  Certificate certificate;
  const double tolerance = kOfGap * std::min(1., estimate_gap(discrete, solution.stress, pair.v, progress));
  const LawOnMesh laws(discrete.problem.material, discrete.mesh, tolerance, progress);
  std::vector<std::string> unmet = reasons_against(discrete, solution, pair, laws, progress);
  Totals totals(discrete.triangles());
  Owners owners(discrete.triangles());
  std::iota(owners.begin(), owners.end(), 0);
  const bool has_quantities = !discrete.problem.quantities.empty();
  PairSums* const sums = has_quantities ? &certificate.sums.emplace(discrete.triangles()) : nullptr;
  LoadsBroughtBack of_patches;
  if (discrete.spaces().components == 1) {
    of_patches = add_patches(discrete, solution, pair, tolerance, owners, totals, progress);
    totals.add<1>(discrete, laws, pair, MembraneSums(discrete, solution.stress, pair, norms), owners,
                  progress, nullptr, sums);
  } else {
    totals.add<2>(discrete, laws, pair, ElasticSums(discrete, solution, pair.v, *pair.tractions, norms),
                  owners, progress, nullptr, sums);
  }
  if (totals.endless_gap) unmet.push_back(*totals.endless_gap);
  CarriedLoads carried = carry_uncertain_loads(discrete, laws, pair.pressure, of_patches);
  if (!carried.is_held) unmet.push_back(nothing_takes(pair.pressure.lacks));
  const bool is_little = carried.norm <= kLittle * bound_from(totals).value;
  // What the pressure of an iteration lacks that did not converge is not worth a factor.
  if (carried.is_held && carried.are_of_data && !is_little)
    carried.norm =
        std::min(carried.norm, carried_by_motions(discrete, laws, carried.loads, carried.root, progress));
  totals.add(carried);
  certificate.bound = bound_from(totals);
  certificate.bound.work =
      work_from(totals, certificate.bound, totals.all.stress / 2 - solution.summary.energy,
                supports_rest(discrete.problem));
  if (are_lost(totals, solution.stress)) certificate.bound.value = std::numeric_limits<double>::infinity();
  certificate.squares = std::move(totals.shares);
  certificate.pressure = pressure_where(owners, discrete, pair.pressure);
  certificate.bound.unmet = std::move(unmet);
  certificate.bound.guaranteed = certificate.bound.unmet.empty();
  if (has_quantities) certificate.pair = std::make_unique<AdmissiblePair>(std::move(pair));
  return certificate;
}

}  // namespace

Certificate certify(const Discretization& discrete, const Solution& solution, const Eigen::VectorXd& coupling,
                    ShapeNorms& norms, Progress& progress) {
  try {
    return certify_sound_data(discrete, solution, coupling, norms, progress);
  } catch (const InvalidProblem& unsound) {
    return without_bound(unsound.faults());
  }
}

void move_to(const Eigen::MatrixXd& stress, const Discretization& discrete, const Solution& solution,
             Certificate& certificate, Progress& progress) {
  if (!certificate.has_bound()) return;
  constexpr double tolerance = 1e-4;
  const LawOnMesh laws(discrete.problem.material, discrete.mesh, tolerance, progress);
  const Eigen::VectorXd way = energy_norm_squares(discrete, stress - solution.stress, laws, progress);
  const double distance = std::sqrt(way.sum()),
               size = std::sqrt(energy_norm_squares(discrete, stress, laws, progress).sum());
  ErrorBound& bound = certificate.bound;
  bound.value += distance;
  bound.parts.equilibration += distance;
  bound.relative = size > 0 ? bound.value / size : (bound.value > 0 ? 1 : 0);
  certificate.squares += way;
}

}  // namespace signorini
