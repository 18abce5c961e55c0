#include "sweep.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "contact/residuals.hpp"
#include "result/flux_functional.hpp"
#include "result/outcome.hpp"

namespace signorini {

SweepEntry entry_of(Solution solution) {
  SweepEntry entry;
  const Summary& summary = solution.summary;
  entry.outcome = summary.outcome;
  entry.advice = summary.advice;
  entry.iterations = summary.iterations;
  entry.energy = summary.energy;
  entry.penetration = summary.residuals.penetration;
  entry.tension = summary.residuals.tension;
  entry.complementarity = summary.residuals.complementarity;
  entry.sums = summary.contact;
  entry.parts = summary.parts;
  entry.contact = std::move(solution.contact);
  entry.error_bound = summary.error_bound;
  entry.quantities = summary.quantities;
  return entry;
}

namespace {

/// By how much the gap has grown at each row, if the change is a function of the clearance space.
std::optional<Eigen::VectorXd> growth(const ClearanceSpace& before, const ClearanceSpace& after, int order) {
  Eigen::VectorXd grown(after.rows.size());
  for (Eigen::Index i = 0; i < grown.size(); ++i) grown[i] = after.rows[i].gap - before.rows[i].gap;
  double largest_gap = 0, farthest = 0;
  for (std::size_t e = 0; e < after.edges.size(); ++e)
    for (int j = 0; j <= order; ++j) {
      const double old_gap = before.edges[e].gap[j], new_gap = after.edges[e].gap[j];
      largest_gap = std::max({largest_gap, std::abs(old_gap), std::abs(new_gap)});
      farthest = std::max(farthest, std::abs(new_gap - old_gap - grown[after.edges[e].rows[j]]));
    }
  constexpr double rounding = 1e-13;
  return farthest <= rounding * largest_gap ? std::optional(grown) : std::nullopt;
}

/// The entries of the contact unknowns among those of all rows.
Eigen::VectorXd of_unknowns(const ClearanceSpace& space, const Eigen::VectorXd& rows) {
  Eigen::VectorXd unknowns(space.unknowns);
  for (std::size_t i = 0; i < space.rows.size(); ++i)
    if (space.rows[i].unknown >= 0) unknowns[space.rows[i].unknown] = rows[i];
  return unknowns;
}

Eigen::VectorXd beyond(const ClearanceSpace& space) {
  Eigen::VectorXd all(space.rows.size());
  std::ranges::transform(space.rows, all.begin(), &ClearanceRow::beyond);
  return all;
}

/// The clearances of a solution, an entry a row.
Eigen::VectorXd clearances(const std::vector<ContactPart>& parts) {
  std::vector<double> all;
  for (const ContactPart& part : parts) all.insert(all.end(), part.clearance.begin(), part.clearance.end());
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

/// A sum of fluxes, which is affine in the contact unknowns.
struct AffineForce {
  double value;
  Eigen::VectorXd response;

  double after(const Eigen::VectorXd& change) const { return value + response.dot(change); }
};

}  // namespace

/// A variation that was recovered, and how its numbers change with λ − s.
class Sweep::Reference {
 public:
  /// `condense(problem)` eliminates. One that is shown is not asked for other gaps.
  template <typename Condense>
  Reference(Problem posed, const Condense& condense, const Settings& settings, Progress& progress,
            KeptDuals& kept, const ShowSolution& show)
      : problem_(std::move(posed)), condensed_(condense(problem_)), contact_(condensed_.contact()) {
    Solution solution = condensed_.solve(settings, progress, {}, &kept);
    if (show) show(solution);
    clearance_ = of_unknowns(space(), clearances(solution.contact) - beyond(space()));
    displacement_ = solution.displacement.lpNorm<Eigen::Infinity>();
    mean_stress_ = mean_stress(condensed_.discretization(), solution.stress, solution.displacement,
                               space().clearance(clearance_));
    if (!show && problem_.quantities.empty()) observe(solution.stress, progress);
    entry_ = entry_of(std::move(solution));
  }

  const SweepEntry& entry() const { return entry_; }
  const ClearanceSpace& space() const { return condensed_.discretization().clearance; }
  const std::string& load_key() const { return problem_.load_key; }
  const std::shared_ptr<const Operator>& used_operator() const { return condensed_.used_operator(); }

  /// The solution for the problem's gaps, if these two differ in the gaps alone and the change is a function
  /// of the clearance space.
  std::optional<SweepEntry> with_gaps_of(const Problem& varied, const Settings& settings,
                                         Progress& progress) {
    if (varied.load_key.empty() || varied.load_key != problem_.load_key) return std::nullopt;
    progress.enter(Phase::iterate);
    const ClearanceSpace after = make_clearance_space(varied, condensed_.discretization().mesh);
    const auto grown = growth(space(), after, condensed_.discretization().spaces().order);
    if (!grown || is_far(after, displacement_)) return std::nullopt;
    const Eigen::VectorXd shift = of_unknowns(space(), *grown);
    contact_.c = condensed_.contact().c + symmetric_product(contact_.s, shift, progress);
    const ContactResult found =
        find_clearance(contact_, settings.method, progress, [this](const auto&) -> BodyState {
          return {mean_stress_, {}};
        });
    return entry_for(after, found, found.clearance - shift - clearance_, settings, progress);
  }

 private:
  void observe(const Eigen::MatrixXd& stress, Progress& progress) {
    const Discretization& discretization = condensed_.discretization();
    Factor::Workspace workspace;
    const auto affine = [&](const FluxFunctional& functional, bool answers) -> AffineForce {
      const double value = functional(discretization, stress);
      if (!answers) return {value, Eigen::VectorXd::Zero(contact_.size())};
      return {value, response(functional, discretization, *condensed_.used_operator(), workspace, progress)};
    };
    for (const BoundaryPart& part : discretization.mesh.boundary) {
      const bool free = !condition_on<Fixed>(problem_, part.name) &&
                        !condition_on<Roller>(problem_, part.name) &&
                        !condition_on<Contact>(problem_, part.name);
      reactions_.emplace_back();
      for (const FluxFunctional& functional : reactions_on(discretization, part))
        reactions_.back().push_back(affine(functional, !free));
    }
    for (std::size_t i = 0; i < space().rows.size(); ++i)
      if (space().rows[i].unknown < 0)
        held_.emplace(i, affine(contact_force_on(discretization, static_cast<int>(i)), true));
  }

  /// `change` is that of λ − s.
  SweepEntry entry_for(const ClearanceSpace& after, const ContactResult& found, const Eigen::VectorXd& change,
                       const Settings& settings, Progress& progress) const {
    const Eigen::VectorXd forces = contact_.force(found.clearance, progress);
    const Eigen::VectorXd pressure = contact_pressure(after, forces_on_rows(after, forces, change));
    const Mesh& mesh = condensed_.discretization().mesh;
    SweepEntry entry;
    const Residuals left = contact_residuals_of(found.clearance, forces);
    entry.penetration = left.penetration;
    entry.tension = left.tension;
    entry.complementarity = left.complementarity;
    entry.outcome = judged(found.outcome, left, settings);
    entry.iterations = progress.iterations();
    entry.advice = advice(settings, entry.outcome, entry.iterations);
    entry.energy = energy_after(change, progress);
    entry.contact = contact_parts(after, mesh, after.clearance(found.clearance), pressure);
    entry.sums = sum_up(entry.contact);
    for (std::size_t part = 0; part < mesh.boundary.size(); ++part) {
      std::vector<double> values;
      for (const AffineForce& force : reactions_[part]) values.push_back(force.after(change));
      entry.parts.push_back(make_reaction(mesh.boundary[part].name, values));
    }
    return entry;
  }

  Eigen::VectorXd forces_on_rows(const ClearanceSpace& after, const Eigen::VectorXd& on_unknowns,
                                 const Eigen::VectorXd& change) const {
    Eigen::VectorXd forces(after.rows.size());
    for (std::size_t i = 0; i < after.rows.size(); ++i)
      forces[i] = after.rows[i].unknown >= 0 ? on_unknowns[after.rows[i].unknown] : held_.at(i).after(change);
    return forces;
  }

  /// ½ μᵀ S μ − cᵀ μ for μ = λ − s, as far as it differs from that of the reference.
  double energy_after(const Eigen::VectorXd& change, Progress& progress) const {
    const Eigen::VectorXd between = clearance_ + 0.5 * change;
    return entry_.energy + change.dot(condensed_.contact().force(between, progress));
  }

  Residuals contact_residuals_of(const Eigen::VectorXd& clearance, const Eigen::VectorXd& forces) const {
    const ContactResiduals left =
        contact_residuals(clearance, forces.cwiseQuotient(contact_.weight), contact_.weight, mean_stress_);
    Residuals residuals;
    residuals.penetration = left.penetration;
    residuals.tension = left.tension;
    residuals.complementarity = left.complementarity;
    return residuals;
  }

  const Problem problem_;
  CondensedProblem condensed_;
  ContactComplement contact_;  ///< for the gaps of the entry at hand
  Eigen::VectorXd clearance_;
  double displacement_ = 0;  ///< the largest of the variation that was recovered
  double mean_stress_ = 0;   ///< of the variation that was recovered; its entries' residuals are by it
  SweepEntry entry_;
  std::vector<std::vector<AffineForce>> reactions_;  ///< by part
  std::map<std::size_t, AffineForce> held_;          ///< on rows that are no unknowns
};

Sweep::Sweep(const Problem& problem, std::shared_ptr<const Operator> kept, const Settings& settings)
    : problem_(problem),
      settings_(settings),
      varied_(problem),
      mesh_(kept->shared_mesh()),
      operator_(std::move(kept)) {}

Sweep::Sweep(Sweep&&) noexcept = default;
Sweep::~Sweep() = default;

/// Whether the operator is that of the variation. That of a material without a key is not kept.
bool Sweep::is_at_hand(const Variation& variation) const {
  return operator_ && material_key_ == (variation.material ? variation.material_key : "") &&
         !(variation.material && variation.material_key.empty());
}

void Sweep::begin_anew() {
  reference_.reset();
}

std::vector<std::size_t> Sweep::starts(const std::vector<Variation>& sweep, std::size_t first,
                                       Progress& progress) const {
  // Of the variation that the next one would refer to.
  std::optional<ClearanceSpace> space;
  std::string load_key, material_key = material_key_;
  if (reference_) {
    space = reference_->space();
    load_key = reference_->load_key();
  }
  const int order = spaces_of(problem_.scheme, components(problem_.material)).order;
  Problem varied = problem_;
  std::vector<std::size_t> starts;
  for (std::size_t i = first; i < sweep.size(); ++i) {
    progress.check();
    const Variation& variation = sweep[i];
    apply(variation, problem_, varied);
    const std::string own_key = variation.material ? variation.material_key : std::string();
    const bool is_other = !space || !problem_.quantities.empty() || varied.load_key.empty() ||
                          varied.load_key != load_key || own_key != material_key ||
                          (variation.material && own_key.empty());
    try {
      ClearanceSpace after = make_clearance_space(varied, *mesh_);
      if (!is_other && growth(*space, after, order)) continue;
      space = std::move(after);
    } catch (const InvalidProblem&) {
      if (!is_other) continue;  // it has no solution, and the next one refers to that before it
      space.reset();
    }
    load_key = varied.load_key;
    material_key = own_key;
    starts.push_back(i);
  }
  return starts;
}

SweepEntry Sweep::solve(const Variation& variation, Progress& progress, const ShowSolution& show) {
  apply(variation, problem_, varied_);
  std::optional<SweepEntry> entry;
  if (!is_at_hand(variation)) {
    // Before the next one is made: there is memory for one.
    reference_.reset();
    kept_.clear();
    operator_.reset();
  }
  // Quantities are enclosed by fields.
  if (reference_ && !show && problem_.quantities.empty())
    entry = reference_->with_gaps_of(varied_, settings_, progress);
  if (!entry) {
    reference_.reset();
    const auto condense = [&](const Problem& posed) {
      return operator_ ? CondensedProblem(posed, operator_, progress)
                       : CondensedProblem(posed, mesh_, settings_.factorization, progress);
    };
    reference_ = std::make_unique<Reference>(varied_, condense, settings_, progress, kept_, show);
    const bool is_known = !variation.material || !variation.material_key.empty();
    operator_ = is_known ? reference_->used_operator() : nullptr;
    material_key_ = variation.material ? variation.material_key : "";
    entry = reference_->entry();
  }
  return *entry;
}

}  // namespace signorini
