#include "run/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "certify/quantities/quantity_enclosure.hpp"
#include "certify/quantities/reflection.hpp"
#include "contact/residuals.hpp"
#include "fem/edge_pieces.hpp"
#include "fem/lagrange.hpp"
#include "fem/per_shape.hpp"
#include "fem/quadrature.hpp"
#include "run/openings.hpp"

namespace signorini {
namespace {

/// What integrals of squares may be off by where the law varies, beside the square of R relative to the
/// stress.
constexpr double kOfRadius = 2e-5;

/// Neighbours differ in stress by R^{2/3}, relative to it: then x of Theorem 4 is about as large as R, for it
/// is the error of a solution that is singular where contact begins. A larger step bends the way; a smaller
/// one is paid for by x²/K.
constexpr double kLeastRadius = 1e-4;
double relative_step(double relative_radius) {
  return std::pow(std::max(relative_radius, kLeastRadius), 2. / 3);
}
/// So much smaller or larger is as good.
constexpr double kLeastStep = 0.5, kMostStep = 4;
/// The guess is no further off: what moves the stress by less does not touch what is asked for.
constexpr double kMostCorrection = 100;

/// A way that is so short beside R leaves the width to R² / z: a step that makes both equal is better.
constexpr double kShortWay = 0.25;

/// Where the data of a neighbour contradict each other, as at a support beside a contact that nearly touches,
/// a shorter step may not.
constexpr int kTries = 3;
constexpr double kShorter = 1. / 16;

/// In words: the quantity depends on more than the energy.
const std::string kUnbounded =
    "no interval is claimed, because no bound of the energy bounds this where a contact touches beside a "
    "support, or "
    "where its weight jumps: let the weight vanish there, or ask for the sum over both parts with one "
    "motion; ";

double largest_of(const Field& field, const Mesh& mesh, const std::vector<int>& edges) {
  double most = 0;
  for (const int edge : edges)
    for (const double s : {0., 0.5, 1.}) {
      const auto [x, normal] = mesh.on_boundary(edge, s);
      most = std::max(most, std::abs(field(x, normal)));
    }
  return most;
}

/// About what the stress changes by per z, in the norm of C: in two dimensions the energy of a body whose
/// boundary moves by w is E w², that of one on which the force F acts is F² / E, whatever its size, and less
/// where the force is spread out. A guess beyond kLeastStep and kMostStep costs a solve.
double guessed_response(const Quantity& quantity, const Mesh& mesh, const Material& material) {
  const double root = std::sqrt(compliance_at(material, mesh.centroid(0)).diagonal().maxCoeff()),
               length = mesh.diameter();
  double moved = 0, force = 0;
  for (const BoundaryPart& part : mesh.boundary) {
    if (const auto found = quantity.weights.find(part.name); found != quantity.weights.end())
      moved = std::max(moved, largest_of(found->second, mesh, part.edges));
    if (const auto found = quantity.motions.find(part.name); found != quantity.motions.end())
      moved = std::max(moved, found->second.translation.norm() + std::abs(found->second.rotation) * length);
    if (const auto found = quantity.densities.find(part.name); found != quantity.densities.end())
      for (const Field& field : found->second.fields()) force += largest_of(field, mesh, part.edges) * length;
  }
  for (const Field& field : quantity.density.fields())
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t)
      force += std::abs(field(mesh.centroid(t))) * AffineMap(mesh.corners(t)).determinant / 2;
  constexpr double of_force = 0.4;
  return moved / root + of_force * force * root;
}

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

/// The problem with the loads of a quantity alone.
Problem loaded_by(const Quantity& quantity, Problem problem) {
  problem.body = {};
  for (auto& [part, condition] : problem.boundary)
    if (std::holds_alternative<Traction>(condition) || std::holds_alternative<Pressure>(condition))
      condition = Traction{};
  Quantity loads;
  loads.density = quantity.density;
  loads.densities = quantity.densities;
  return neighbour(problem, loads, 1);
}

/// A quantity, which must outlive it, with its density projected onto the mesh of a problem.
class QuantityOnMesh {
 public:
  QuantityOnMesh(const Quantity& quantity, const Discretization& discrete, Progress& progress)
      : quantity_(quantity), density_(loaded_by(quantity, discrete.problem), discrete.mesh, &progress) {}

  const Quantity& quantity() const { return quantity_; }

  /// f + z q.
  LoadProjection beside(const LoadProjection& body, double z) const { return body.plus(z, density_); }

  /// (q, u_h) + <r, u_h>.
  double work(const Discretization& discrete, const Fields& fields, Progress& progress) const {
    if (quantity_.has_no_loads()) return 0;
    const Problem problem = loaded_by(quantity_, discrete.problem);
    const Discretization loaded(problem, discrete.mesh, density_, &progress);
    const Eigen::Index free = discrete.traces.free_unknowns();
    return loaded.load.cwiseProduct(fields.displacement).sum() +
           loaded.coupling_load.head(free).dot(fields.coupling.head(free));
  }

 private:
  const Quantity& quantity_;
  const LoadProjection density_;
};

/// A neighbouring problem and its solution, which refer to each other.
class Neighbour {
 public:
  Neighbour(const Neighbour&) = delete;
  Neighbour(const Problem& problem, const QuantityOnMesh& asked, double z, const CondensedProblem& condensed,
            const Fields& fields, const Settings& settings, Progress& progress)
      : problem_(neighbour(problem, asked.quantity(), z)),
        condensed_(problem_, condensed.used_operator(), progress,
                   asked.beside(condensed.discretization().body, z)) {
    fields_ = condensed_.find(settings.method, progress, fields.clearance);
  }

  const Discretization& discretization() const { return condensed_.discretization(); }
  const Fields& fields() const { return fields_; }

  /// Refers to this.
  CertifiedSolution certified(const LawOnMesh& laws, Progress& progress) {
    solution_.stress = fields_.stress;
    solution_.displacement = fields_.displacement;
    solution_.rotation = discretization().traces.rotation(fields_.coupling);
    const Eigen::VectorXd clearance = discretization().clearance.clearance(fields_.clearance);
    solution_.summary.residuals =
        residuals(solution_, clearance, Eigen::VectorXd::Zero(clearance.size()), discretization());
    return {discretization(), solution_,
            admissible_pair(discretization(), solution_, fields_.coupling, progress), laws, progress};
  }

 private:
  Problem problem_;
  CondensedProblem condensed_;
  Fields fields_;
  Solution solution_;
};

/// The mean of a weight over each edge (P0), or its value at each node (P1), an entry a row.
Eigen::VectorXd on_rows(const std::map<std::string, Field>& weights, const Discretization& discrete) {
  const Mesh& mesh = discrete.mesh;
  const ClearanceSpace& space = discrete.clearance;
  const int order = discrete.spaces().order;
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(space.rows.size()));
  for (const ContactEdge& contact : space.edges) {
    const auto weight = weights.find(mesh.boundary[space.rows[contact.rows[0]].part].name);
    if (weight == weights.end()) continue;
    const EdgeLine line(mesh, contact.edge);
    const auto value = [&](double s) { return line.value(weight->second, s); };
    if (order == 0)
      all[contact.rows[0]] = project_onto_edge(0, edge_moments(0, value))[0];
    else
      for (const int k : {0, 1}) all[contact.rows[k]] = value(k);
  }
  return all;
}

/// Q of the discrete solution.
double value_of(const QuantityOnMesh& asked, const Discretization& discrete, const Fields& fields,
                const Solution& solution, Progress& progress) {
  const Quantity& quantity = asked.quantity();
  Eigen::VectorXd forces;
  contact_forces(
      discrete, [&](int t) -> LocalVector { return solution.stress.col(t); }, forces);
  double sum = asked.work(discrete, fields, progress) + on_rows(quantity.weights, discrete).dot(forces);
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
  /// Takes the pair of the certificate.
  Encloser(const CondensedProblem& condensed, const Fields& fields, const Solution& solution,
           const Settings& settings, Certificate& certificate, Progress& progress)
      : condensed_(condensed),
        fields_(fields),
        solution_(solution),
        settings_(settings),
        progress_(progress),
        laws_(discrete().problem.material, discrete().mesh,
              kOfRadius * std::min(1., std::pow(certificate.bound.relative, 2)), progress),
        base_(discrete(), solution, std::move(*certificate.pair), laws_, progress),
        enclosure_(base_, laws_, progress),
        size_(norm_of(solution.stress, discrete())) {}

  EnclosedQuantity operator()(const Quantity& quantity) {
    EnclosedQuantity own;
    own.name = quantity.name;
    if (quantity.openings.empty())
      enclose_by_neighbours(quantity, own);
    else
      enclose_opening(quantity, own);
    own.guaranteed = own.is_bounded() && own.unmet.empty();
    if (own.is_bounded() && !(own.lower <= own.value && own.value <= own.upper))
      own.estimate = (own.lower + own.upper) / 2;
    if (quantity.is_mean) own *= 1 / length_of_parts(quantity, discrete().mesh);
    if (!std::isfinite(own.value) || !std::isfinite(own.estimate))
      throw SolveError("the numbers of the quantity " + own.name +
                       " leave the range of double precision: take a smaller weight");
    return own;
  }

 private:
  const Discretization& discrete() const { return condensed_.discretization(); }

  void enclose_opening(const Quantity& quantity, EnclosedQuantity& own) {
    own.value = own.estimate =
        opening_of(quantity, discrete(), discrete().clearance.clearance(fields_.clearance));
    own.unmet = base_.unmet;
    const auto [lower, upper] =
        signorini::enclose_opening(quantity, base_, enclosure_.radius(), settings_, progress_, own.unmet);
    own.lower = lower;
    own.upper = upper;
  }

  void enclose_by_neighbours(const Quantity& quantity, EnclosedQuantity& own) {
    const QuantityOnMesh asked(quantity, discrete(), progress_);
    own.value = own.estimate = value_of(asked, discrete(), fields_, solution_, progress_);
    double shorter = 1;
    for (int tries = 0; tries < kTries; ++tries, shorter *= kShorter) {
      own.unmet = base_.unmet;
      try {
        enclose(asked, shorter, own);
        if (own.unmet.size() == base_.unmet.size()) break;
      } catch (const InvalidProblem& unsound) {
        const Fault& fault = unsound.faults().front();
        add({kUnbounded + fault.where + " " + fault.detail}, own.unmet);
      } catch (const SolveError& failure) {
        add({failure.what()}, own.unmet);
      }
    }
  }

  std::unique_ptr<Neighbour> at(const QuantityOnMesh& asked, double z) const {
    return std::make_unique<Neighbour>(discrete().problem, asked, z, condensed_, fields_, settings_,
                                       progress_);
  }

  /// By neighbours that are so much nearer than what is best.
  void enclose(const QuantityOnMesh& asked, double shorter, EnclosedQuantity& own) {
    const Quantity& quantity = asked.quantity();
    const double radius = enclosure_.radius(), target = size_ > 0 ? relative_step(radius / size_) * size_ : 0;
    const double response = guessed_response(quantity, discrete().mesh, discrete().problem.material);
    double z = shorter * (response > 0 && target > 0 ? target / response : 1);
    std::unique_ptr<Neighbour> plus = at(asked, z);
    const double moved = norm_of(plus->fields().stress - solution_.stress, discrete());
    const double wanted = shorter * target;
    if (wanted > 0 && moved > 0 && (moved < kLeastStep * wanted || moved > kMostStep * wanted)) {
      z *= std::clamp(wanted / moved, 1 / kMostCorrection, kMostCorrection);
      plus = at(asked, z);
    }
    QuantityEnclosure::Bounds found = bounds(asked, *plus, z, own.unmet);
    if (own.unmet.size() == base_.unmet.size() && 0 < found.way && found.way < kShortWay * radius) {
      plus.reset();
      std::vector<std::string> unmet = own.unmet;
      const double longer = z * radius / found.way;
      QuantityEnclosure::Bounds other = bounds(asked, *at(asked, longer), longer, unmet);
      if (unmet.size() == own.unmet.size() && other.upper - other.lower < found.upper - found.lower)
        found = std::move(other);
    }
    own.lower = found.lower;
    own.upper = found.upper;
    // The largest that there is in memory, and asked for by a mesh that refines itself alone.
    const std::optional<Adaptive>& adaptive = discrete().problem.mesh.adaptive;
    if (adaptive && adaptive->quantity == quantity.name) own.shares = std::move(found.shares);
  }

  /// By a neighbour at z, and one at −z where that will not do. Adds to `unmet` why they do not count.
  QuantityEnclosure::Bounds bounds(const QuantityOnMesh& asked, Neighbour& plus, double z,
                                   std::vector<std::string>& unmet) {
    const Quantity& quantity = asked.quantity();
    const CertifiedSolution of_plus = plus.certified(laws_, progress_);
    add(of_plus.unmet, unmet);
    if (is_admissible_reflected(base_, of_plus, quantity, z, progress_))
      return enclosure_.reflected(quantity, of_plus, z);
    const std::unique_ptr<Neighbour> minus = at(asked, -z);
    const CertifiedSolution of_minus = minus->certified(laws_, progress_);
    add(of_minus.unmet, unmet);
    return enclosure_(quantity, of_plus, of_minus, z);
  }

  const CondensedProblem& condensed_;
  const Fields& fields_;
  const Solution& solution_;
  const Settings& settings_;
  Progress& progress_;
  const LawOnMesh laws_;
  const CertifiedSolution base_;
  const QuantityEnclosure enclosure_;
  const double size_;  ///< ‖σ_h‖_C
};

}  // namespace

void enclose_quantities(const CondensedProblem& condensed, const Fields& fields, const Solution& solution,
                        const Settings& settings, Certificate& certificate, Progress& progress) {
  const std::vector<Quantity>& quantities = condensed.discretization().problem.quantities;
  if (quantities.empty() || !certificate.has_bound()) return;
  SilentObserver silent(progress.observer());
  Progress within(silent, progress.time_left());
  Encloser enclose(condensed, fields, solution, settings, certificate, within);
  for (const Quantity& quantity : quantities) certificate.quantities.push_back(enclose(quantity));
}

}  // namespace signorini
