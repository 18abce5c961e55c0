#include "contact/paper_uzawa.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "contact/residuals.hpp"
#include "fem/per_shape.hpp"
#include "system/elimination.hpp"
#include "system/factorize.hpp"

namespace signorini {
namespace {

/// The operator of the iteration does not expand distances when it converges, so increments do not grow;
/// this factor over the first one is divergence beyond doubt.
constexpr double kDivergence = 1e8;

/// What the elimination of a triangle shape gives.
struct Shape {
  LocalMatrix stiffness;     ///< K_r
  LocalMatrix coupling;      ///< P
  LocalMatrix divergence;    ///< D
  LocalMatrix mass_inverse;  ///< V⁻¹
};

/// One local matrix out of a column of them. Its products are lazyProduct(): it is so small that the call of
/// a kernel for large matrices would cost more than the product.
auto local(const Eigen::MatrixXd& columns, int triangle, int rows) {
  return Eigen::Map<const Eigen::MatrixXd>(columns.col(triangle).data(), rows, columns.rows() / rows);
}

}  // namespace

UzawaIteration::UzawaIteration(const Discretization& discrete, const PaperUzawa& settings, Factorization by,
                               Progress& progress)
    : discrete_(discrete), settings_(settings) {
  eliminate(by, progress);
  start();
}

void UzawaIteration::eliminate(Factorization by, Progress& progress) {
  const int triangles = discrete_.triangles();
  const int n = discrete_.traces.dofs_per_triangle(), nv = discrete_.spaces().displacements();
  coupling_.resize(n * nv, triangles);
  divergence_.resize(nv * nv, triangles);
  load_.resize(nv, triangles);
  stiffness_of_.assign(triangles, -1);
  int held = 0;
  for (int t = 0; t < triangles; ++t)
    if (!is_free(t)) stiffness_of_[t] = held++;
  stiffness_.reserve(static_cast<std::size_t>(n) * n * held);
  ElementSum matrix;
  matrix.size = discrete_.traces.free_unknowns();
  matrix.per_element = n;
  PerShape<Shape> shapes(discrete_);
  for (int t = 0; t < triangles; ++t) {
    progress.check_in(t);
    const Shape& shape = shapes(t, [&](const ElementMatrices& matrices) -> Shape {
      const AugmentedElimination elimination(matrices, discrete_.spaces(), settings_.augmentation);
      return {elimination.stiffness(), elimination.coupling(), elimination.divergence(),
              matrices.displacement_mass.inverse()};
    });
    load_.col(t).noalias() = shape.mass_inverse.lazyProduct(discrete_.load.col(t));
    coupling_.col(t) = shape.coupling.reshaped();
    divergence_.col(t) = shape.divergence.reshaped();
    add_free(matrix, t, shape.stiffness);
    if (stiffness_of_[t] >= 0)
      stiffness_.insert(stiffness_.end(), shape.stiffness.data(), shape.stiffness.data() + n * n);
  }
  progress.enter(Phase::factorize);
  matrix.tree = tree_by_edges(matrix.centres, discrete_.mesh.triangle_edges, progress);
  factor_ = std::make_unique<const Factor>(factorize(matrix, 0, by, progress));
}

/// Whether all unknowns of a triangle are.
bool UzawaIteration::is_free(int t) const {
  const TraceSpace& traces = discrete_.traces;
  for (int i = 0; i < traces.dofs_per_triangle(); ++i)
    if (!traces.is_free(traces.dof(t, i))) return false;
  return true;
}

Eigen::Map<const Eigen::MatrixXd> UzawaIteration::stiffness(int t) const {
  const std::ptrdiff_t n = discrete_.traces.dofs_per_triangle();
  return {stiffness_.data() + n * n * stiffness_of_[t], n, n};
}

/// Adds the stiffness of a triangle between its free unknowns.
void UzawaIteration::add_free(ElementSum& matrix, int t, const LocalMatrix& stiffness) const {
  const TraceSpace& traces = discrete_.traces;
  LocalMatrix turned = stiffness;
  if (traces.is_turned(t)) turned = traces.to_xy(t).transpose() * stiffness * traces.to_xy(t);
  for (int i = 0; i < traces.dofs_per_triangle(); ++i) {
    const int dof = traces.dof(t, i);
    matrix.unknowns.push_back(traces.is_free(dof) ? traces[dof].unknown : -1);
  }
  matrix.matrix_of.push_back(matrix.keep(turned.data()));
  matrix.centres.push_back(discrete_.mesh.centroid(t));
}

void UzawaIteration::start() {
  displacement_ = Eigen::MatrixXd::Constant(load_.rows(), load_.cols(), settings_.initial_displacement);
  clearance_.resize(discrete_.clearance.unknowns);
  weight_.resize(discrete_.clearance.unknowns);
  pressure_.resize(discrete_.clearance.unknowns);
  const double u = settings_.initial_displacement;
  for (const ContactEdge& contact : discrete_.clearance.edges) {
    const double normal_displacement = discrete_.spaces().components == 1 ? -u : u * contact.direction.sum();
    for (int j = 0; j <= discrete_.spaces().order; ++j) {
      const ClearanceRow& row = discrete_.clearance.rows[contact.rows[j]];
      if (row.unknown < 0) continue;
      clearance_[row.unknown] = std::max(0., row.gap - normal_displacement);
      weight_[row.unknown] = row.weight;
    }
  }
  mass_inverse_ = discrete_.spaces().displacement_mass.inverse();
  determinant_.resize(discrete_.triangles());
  for (int t = 0; t < discrete_.triangles(); ++t)
    determinant_[t] = AffineMap(discrete_.mesh.corners(t)).determinant;
  x_ = given_ = Eigen::VectorXd::Zero(discrete_.traces.unknowns());
  imbalance_.resizeLike(load_);
}

void UzawaIteration::augment(const Eigen::MatrixXd& displacement) {
  augmented_ = displacement + settings_.augmentation * load_;
}

void UzawaIteration::solve_first_equation(Progress& progress) {
  const int n = discrete_.traces.dofs_per_triangle(), free = discrete_.traces.free_unknowns();
  right_ = discrete_.coupling_load.head(free);
  given_.tail(clearance_.size()) = clearance_;
  augment(displacement_);
  for (int t = 0; t < discrete_.triangles(); ++t) {
    // t − E σ of the data alone: P (u + r Πf) − K_r m with the free traces at 0.
    LocalVector flux = local(coupling_, t, n).lazyProduct(augmented_.col(t));
    if (stiffness_of_[t] >= 0) flux -= stiffness(t).lazyProduct(discrete_.traces.values(t, given_));
    if (discrete_.traces.is_turned(t)) flux = (discrete_.traces.to_xy(t).transpose() * flux).eval();
    for (int j = 0; j < n; ++j) {
      const int dof = discrete_.traces.dof(t, j);
      if (discrete_.traces.is_free(dof)) right_[discrete_.traces[dof].unknown] += flux[j];
    }
  }
  factor_->solve(right_, workspace_, progress);
  x_.head(free) = right_;
  x_.tail(clearance_.size()) = clearance_;
}

void UzawaIteration::update_displacement() {
  const int n = discrete_.traces.dofs_per_triangle();
  last_displacement_ = displacement_;
  for (int t = 0; t < discrete_.triangles(); ++t) {
    const LocalVector m = discrete_.traces.values(t, x_);
    LocalVector divergence = local(coupling_, t, n).transpose().lazyProduct(m);
    divergence -= local(divergence_, t, static_cast<int>(divergence.size())).lazyProduct(augmented_.col(t));
    imbalance_.col(t) = mass_inverse_.lazyProduct(divergence) / determinant_[t] + load_.col(t);
  }
  displacement_ += settings_.rho * imbalance_;
}

/// −σ_n^m = <−σ_n^m, φ_i> / <1, φ_i> from the traces and displacements of σ^m.
void UzawaIteration::update_pressure() {
  contact_forces(
      discrete_, [this](int t) { return flux_on_contact(t); }, forces_);
  for (std::size_t i = 0; i < discrete_.clearance.rows.size(); ++i)
    if (const int unknown = discrete_.clearance.rows[i].unknown; unknown >= 0)
      pressure_[unknown] = forces_[static_cast<Eigen::Index>(i)] / weight_[unknown];
}

LocalVector UzawaIteration::flux_on_contact(int t) const {
  LocalVector flux = stiffness(t).lazyProduct(discrete_.traces.values(t, x_));
  flux -= local(coupling_, t, static_cast<int>(flux.size())).lazyProduct(augmented_.col(t));
  return flux;
}

void UzawaIteration::update_clearance() {
  last_clearance_ = clearance_;
  update_pressure();
  clearance_ = (clearance_ - settings_.rho * pressure_).cwiseMax(0);
}

Iteration UzawaIteration::record() {
  const double imbalance = imbalance_.norm();
  if (first_imbalance_ == 0) first_imbalance_ = std::max(imbalance, load_.norm());
  largest_pressure_ = std::max(largest_pressure_, pressure_.lpNorm<Eigen::Infinity>());
  const ContactResiduals left = contact_residuals(clearance_, pressure_, weight_, largest_pressure_);
  Iteration iteration;
  iteration.displacement_change = relative_change(last_displacement_, displacement_);
  iteration.clearance_change = relative_change(last_clearance_, clearance_);
  iteration.equilibrium = first_imbalance_ > 0 ? imbalance / first_imbalance_ : 0;
  iteration.penetration = left.penetration;
  iteration.tension = left.tension;
  iteration.complementarity = left.complementarity;
  iteration.active = static_cast<int>((clearance_.array() == 0).count());
  return iteration;
}

Outcome UzawaIteration::run(Progress& progress) {
  double first_change = 0;
  while (progress.iterations() < settings_.max_iterations) {
    try {
      solve_first_equation(progress);
    } catch (const TimeUp&) {
      if (progress.iterations() == 0) throw;
      augment(last_displacement_);  // as it was for σ^m, whose traces are still there
      return Outcome::time_limit;
    }
    update_displacement();
    update_clearance();
    const double change =
        (displacement_ - last_displacement_).lpNorm<1>() + (clearance_ - last_clearance_).lpNorm<1>();
    if (progress.iterations() == 0) first_change = change;
    if (!std::isfinite(change)) {
      displacement_ = last_displacement_;
      clearance_ = last_clearance_;
      return Outcome::diverged;
    }
    const Iteration iteration = record();
    const bool in_time = progress.record(iteration);
    if (change > kDivergence * first_change) return Outcome::diverged;
    if (*iteration.displacement_change <= settings_.tolerance) return Outcome::converged;
    if (!in_time) return Outcome::time_limit;
  }
  return Outcome::iteration_limit;
}

Eigen::MatrixXd UzawaIteration::stress() const {
  Eigen::MatrixXd stress(discrete_.spaces().stresses(), discrete_.mesh.triangles.size());
  PerShape<AugmentedElimination> eliminations(discrete_);
  for (int t = 0; t < discrete_.triangles(); ++t) {
    const AugmentedElimination& elimination = eliminations(t, [&](const ElementMatrices& matrices) {
      return AugmentedElimination(matrices, discrete_.spaces(), settings_.augmentation);
    });
    stress.col(t) = elimination.stress(discrete_.traces.values(t, x_), augmented_.col(t));
  }
  return stress;
}

}  // namespace signorini
