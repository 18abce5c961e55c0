#include "run/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "certify/data/oscillation.hpp"
#include "certify/quantities/quantity_enclosure.hpp"
#include "contact/residuals.hpp"
#include "fem/edge_pieces.hpp"
#include "fem/lagrange.hpp"
#include "fem/per_shape.hpp"
#include "fem/quadrature.hpp"

namespace signorini {
namespace {

/// What integrals of squares may be off by where the law varies, beside the square of R relative to the
/// stress.
constexpr double kOfRadius = 2e-5;

/// x of Theorem 4 is about r^{1/3}, r = R relative to the stress, relative to the stress of the dual problem,
/// and K costs nothing up to x / R. Below the least r a larger K tells nothing more. A motion without stress
/// is a change, too.
constexpr double kLeastRadius = 1e-4;
double best_factor(double r, double relative_size) {
  return relative_size * std::pow(std::max(r, kLeastRadius), -2. / 3);
}

/// Where K turns out to be so much smaller than x / R, x is larger than it must be.
constexpr double kMuchTooSmall = 0.3;

/// 1 where there is nothing to compare with.
double ratio(double one, double other) {
  return other > 0 ? one / other : 1;
}

/// In words: the quantity depends on more than the energy.
const std::string kUnbounded =
    "no interval is claimed, because no bound of the energy bounds this where a contact touches beside a "
    "support, or "
    "where its weight jumps: let the weight vanish there, or ask for the sum over both parts with one "
    "motion; ";

double length_of_parts(const Quantity& quantity, const Mesh& mesh) {
  double length = 0;
  for (const BoundaryPart& part : mesh.boundary)
    if (quantity.densities.contains(part.name))
      for (const int edge : part.edges) length += mesh.length(edge);
  return length;
}

/// ‖·‖_C of a discrete stress, by the rule of the scheme.
double norm_of(const Eigen::MatrixXd& stress, const Discretization& discrete) {
  PerShape<LocalMatrix> compliances(discrete);
  double sum = 0;
  for (int t = 0; t < discrete.triangles(); ++t) {
    const LocalMatrix& compliance =
        compliances(t, [](const ElementMatrices& matrices) { return matrices.compliance; });
    const LocalVector own = stress.col(t);
    sum += own.dot(compliance.lazyProduct(own));
  }
  return std::sqrt(sum);
}

/// The mean of a weight over each edge (P0), or its value at each node (P1), an entry a row.
Eigen::VectorXd on_rows(const std::map<std::string, Field>& weights, const Discretization& discrete) {
  const Mesh& mesh = discrete.mesh;
  const ClearanceSpace& space = discrete.clearance;
  const int order = discrete.spaces().order;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(space.rows.size()));
  for (const ContactEdge& contact : space.edges) {
    const Field* weight = weight_on(weights, discrete, contact);
    if (weight == nullptr) continue;
    const EdgeLine line(mesh, contact.edge);
    const auto value = [&](double s) { return line.value(*weight, s); };
    if (order == 0)
      all[contact.rows[0]] = project_onto_edge(0, edge_moments(0, value))[0];
    else
      for (const int k : {0, 1}) all[contact.rows[k]] = value(k);
  }
  return all;
}

/// Neither are pressures and clearances, nor then what such weights weigh.
bool is_nowhere_negative(const Quantity& quantity, const Discretization& discrete) {
  if (!quantity.has_no_loads() || !quantity.motions.empty()) return false;
  const auto& weights = quantity.openings.empty() ? quantity.weights : quantity.openings;
  return std::ranges::none_of(discrete.clearance.edges, [&](const ContactEdge& contact) {
    const Field* weight = weight_on(weights, discrete, contact);
    return weight != nullptr &&
           series_on(*weight, EdgeLine(discrete.mesh, contact.edge), Interval(0, 1), 0)[0].lower() < 0;
  });
}

/// (q, u_h) + <r, u_h>, with the loads of the dual problem.
double work_on(const Eigen::MatrixXd& displacement, const Eigen::VectorXd& coupling,
               const Discretization& loads) {
  const Eigen::Index free = loads.traces.free_unknowns();
  return loads.load.cwiseProduct(displacement).sum() +
         loads.coupling_load.head(free).dot(coupling.head(free));
}

/// Q of the discrete solution.
double value_of(const Quantity& quantity, const Discretization& loads, const Discretization& discrete,
                const Eigen::VectorXd& coupling, const Solution& solution) {
  Eigen::VectorXd forces;
  contact_forces(
      discrete, [&](int t) -> LocalVector { return solution.stress.col(t); }, forces);
  double sum =
      work_on(solution.displacement, coupling, loads) + on_rows(quantity.weights, discrete).dot(forces);
  for (const Reaction& reaction : solution.summary.parts)
    if (const auto found = quantity.motions.find(reaction.part); found != quantity.motions.end()) {
      for (std::size_t c = 0; c < reaction.force.size(); ++c)
        sum += found->second.translation[static_cast<Eigen::Index>(c)] * reaction.force[c];
      sum += found->second.rotation * reaction.moment;
    }
  return sum;
}

void add(const std::vector<std::string>& reasons, std::vector<std::string>& all) {
  for (const std::string& reason : reasons)
    if (std::ranges::find(all, reason) == all.end()) all.push_back(reason);
}

/// Encloses quantities of one solution.
class Encloser {
 public:
  /// Takes the pair of the certificate and its sums.
  Encloser(const CondensedProblem& condensed, const Fields& fields, const Solution& solution,
           Factorization by, Certificate& certificate, KeptDuals& kept, Progress& progress)
      : condensed_(condensed),
        fields_(fields),
        solution_(solution),
        by_(by),
        kept_(kept),
        progress_(progress),
        laws_(discrete().problem.material, discrete().mesh,
              kOfRadius * std::min(1., std::pow(certificate.bound.relative, 2)), progress),
        base_(discrete(), solution, std::move(*certificate.pair), load_remainders(discrete(), progress),
              laws_, progress),
        enclosure_(base_, std::move(*certificate.sums), laws_, kept.norms(condensed), progress),
        size_(norm_of(solution.stress, discrete())) {}

  /// Of quantity i.
  EnclosedQuantity operator()(std::size_t i) {
    const Quantity& quantity = discrete().problem.quantities[i];
    EnclosedQuantity own;
    own.name = quantity.name;
    if (quantity.openings.empty())
      enclose_by_dual(quantity, kept_.dual(condensed_, i, progress_), own);
    else
      enclose_opening(quantity, kept_.pull(condensed_, i, by_, progress_), own);
    if (own.is_bounded() && own.lower < 0 && own.upper >= 0 && is_nowhere_negative(quantity, discrete()))
      own.lower = 0;
    own.guaranteed = own.is_bounded() && own.unmet.empty();
    own.estimate = estimate_within(own.value, own.lower, own.upper);
    if (quantity.is_mean) own *= 1 / length_of_parts(quantity, discrete().mesh);
    if (!std::isfinite(own.value) || !std::isfinite(own.estimate))
      throw SolveError("the numbers of the quantity " + own.name +
                       " leave the range of double precision: take a smaller weight");
    return own;
  }

 private:
  const Discretization& discrete() const { return condensed_.discretization(); }

  void enclose_opening(const Quantity& quantity, const Pull& pull, EnclosedQuantity& own) {
    own.value = opening_of(quantity, discrete(), discrete().clearance.clearance(fields_.clearance));
    own.unmet = base_.unmet;
    const auto [lower, upper] =
        signorini::enclose_opening(quantity, base_, enclosure_.radius(), pull, progress_, own.unmet);
    own.lower = lower;
    own.upper = upper;
  }

  void enclose_by_dual(const Quantity& quantity, CondensedDual& condensed, EnclosedQuantity& own) {
    DualSolution dual(condensed_, condensed);
    own.value = value_of(quantity, dual.discretization(), discrete(), fields_.coupling, solution_);
    own.unmet = base_.unmet;
    try {
      enclose(quantity, dual, own);
    } catch (const InvalidProblem& unsound) {
      const Fault& fault = unsound.faults().front();
      add({kUnbounded + fault.where + " " + fault.detail}, own.unmet);
    } catch (const TimeUp&) {
      throw;  // for those that follow, too
    } catch (const SolveError& failure) {
      add({failure.what()}, own.unmet);
    }
  }

  void enclose(const Quantity& quantity, DualSolution& dual, EnclosedQuantity& own) {
    const double r = size_ > 0 ? enclosure_.radius() / size_ : 0;
    dual.solve(fields_.clearance, std::numeric_limits<double>::infinity(), progress_);
    const double by_stress = ratio(norm_of(dual.stress(), discrete()), size_),
                 largest = std::max(solution_.displacement.lpNorm<Eigen::Infinity>(),
                                    fields_.clearance.lpNorm<Eigen::Infinity>()),
                 by_displacement = ratio(dual.largest_displacement(), largest),
                 factor = best_factor(r, std::max(by_stress, r * by_displacement)),
                 most = std::max(by_stress, by_displacement);
    // Beside a body at rest rounding leaves the less, the smaller the dual solution is taken.
    constexpr double hardly = 1e-100;
    const bool is_at_rest = size_ == 0 && largest == 0;
    const double size = is_at_rest ? hardly : most > 0 ? 1 / most : 1;
    std::vector<std::string> unmet;
    QuantityEnclosure::Bounds found = bounds(dual, factor, size, unmet);
    if (found.factor < kMuchTooSmall * found.free_factor) {
      std::vector<std::string> other_unmet;
      QuantityEnclosure::Bounds other = bounds(dual, found.free_factor, size, other_unmet);
      if (other.upper - other.lower < found.upper - found.lower) {
        found = std::move(other);
        unmet = std::move(other_unmet);
      }
    }
    add(unmet, own.unmet);
    if (!std::isfinite(found.upper - found.lower) && unmet.empty())
      return add({kUnbounded + "the contact touches without a pressure"}, own.unmet);
    own.lower = found.lower;
    own.upper = found.upper;
    // The largest that there is in memory, and asked for by a mesh that refines itself alone.
    const std::optional<Adaptive>& adaptive = discrete().problem.mesh.adaptive;
    if (adaptive && adaptive->quantity == quantity.name) own.shares = std::move(found.shares);
  }

  /// With a K of about this factor; `unmet` tells why they do not count.
  QuantityEnclosure::Bounds bounds(DualSolution& dual, double factor, double size,
                                   std::vector<std::string>& unmet) {
    if (dual.is_beyond(factor)) dual.solve(fields_.clearance, factor, progress_);
    const CertifiedSolution of_dual = dual.certified(base_, factor, laws_, progress_);
    if (const auto& refused = of_dual.pair.v.unmet(); !refused.empty()) {
      unmet = {kUnbounded + refused.front()};
      constexpr double anything = std::numeric_limits<double>::infinity();
      return {-anything, anything, 0, anything, {}};
    }
    unmet = of_dual.unmet;
    return enclosure_(of_dual, size);
  }

  const CondensedProblem& condensed_;
  const Fields& fields_;
  const Solution& solution_;
  const Factorization by_;
  KeptDuals& kept_;
  Progress& progress_;
  const LawOnMesh laws_;
  const CertifiedSolution base_;
  const QuantityEnclosure enclosure_;
  const double size_;  ///< ‖σ_h‖_C
};

}  // namespace

void enclose_quantities(const CondensedProblem& condensed, const Fields& fields, const Solution& solution,
                        Factorization by, Certificate& certificate, KeptDuals& kept, Progress& progress) {
  const std::vector<Quantity>& quantities = condensed.discretization().problem.quantities;
  if (quantities.empty() || !certificate.has_bound()) return;
  SilentObserver silent(progress.observer());
  Progress within(silent, progress);
  Encloser enclose(condensed, fields, solution, by, certificate, kept, within);
  for (std::size_t i = 0; i < quantities.size(); ++i) certificate.quantities.push_back(enclose(i));
}

}  // namespace signorini
