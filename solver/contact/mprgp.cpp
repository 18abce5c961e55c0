#include "contact/mprgp.hpp"

#include <cmath>
#include <limits>

#include <Spectra/SymEigsSolver.h>

#include "contact/multilevel_scaling.hpp"
#include "progress/pace.hpp"

namespace signorini {
namespace {

/// So often the body is asked for its state: what is off after that is rounding, which iterating does not
/// mend.
constexpr int kMostLooks = 4;

/// What is rounding, and so many iterations in a row do not halve, does not fall any more. Conjugate
/// gradients rest for a few now and then.
constexpr int kMostStalls = 8;

/// D^(-1/2) S D^(-1/2), D the diagonal of S, as Spectra asks for its products.
class ScaledComplement {
 public:
  using Scalar = double;

  ScaledComplement(const Eigen::MatrixXd& s, Progress& progress)
      : s_(s), root_(s.diagonal().cwiseSqrt().cwiseInverse()), progress_(progress) {}

  Eigen::Index rows() const { return s_.rows(); }
  Eigen::Index cols() const { return s_.cols(); }
  void perform_op(const double* in, double* out) const {
    progress_.check();
    const Eigen::VectorXd scaled = root_.cwiseProduct(Eigen::Map<const Eigen::VectorXd>(in, rows()));
    Eigen::Map<Eigen::VectorXd>(out, rows()) = root_.cwiseProduct(symmetric_product(s_, scaled, progress_));
  }
  double largest_row_sum() const {
    double largest = 0;
    Pace pace(progress_);
    for (Eigen::Index i = 0; i < rows(); ++i) {
      largest = std::max(largest, root_[i] * s_.col(i).cwiseAbs().dot(root_));
      pace.add(static_cast<std::size_t>(rows()));
    }
    return largest;
  }

 private:
  const Eigen::MatrixXd& s_;
  const Eigen::VectorXd root_;
  Progress& progress_;
};

/// An upper bound of its largest eigenvalue. Lanczos comes from below, to the tolerance; the margin covers
/// that.
double largest_eigenvalue(const ContactComplement& contact, Progress& progress) {
  const Eigen::Index n = contact.size();
  if (n == 1) return 1;
  constexpr double tolerance = 1e-2, margin = 1.02;
  ScaledComplement product(contact.s, progress);
  Spectra::SymEigsSolver<ScaledComplement> lanczos(product, 1, std::min<Eigen::Index>(n, 20));
  lanczos.init();
  lanczos.compute(Spectra::SortRule::LargestAlge, 100, tolerance, Spectra::SortRule::LargestAlge);
  if (lanczos.info() == Spectra::CompInfo::Successful) return margin * lanczos.eigenvalues()[0];
  return product.largest_row_sum();
}

/// The iterate λ with its gradient g = S λ − c, that is w p, and the direction of the conjugate gradients.
class Iterate {
 public:
  Iterate(const ContactComplement& contact, const Eigen::VectorXd& start, Progress& progress)
      : contact_(contact),
        progress_(progress),
        diagonal_(contact.s.diagonal()),
        step_(kPart * 2 / largest_eigenvalue(contact, progress)),
        mean_stress_(kSmallPart * contact.c.cwiseQuotient(contact.weight).lpNorm<Eigen::Infinity>()),
        lost_(Eigen::VectorXd::Zero(contact.size())),
        scaling_(contact.s, progress),
        lambda_(start.size() ? start : Eigen::VectorXd::Zero(contact.size())) {
    evaluate_gradient();
    begin_anew();
  }

  Iteration step() {
    last_ = lambda_;
    if (!is_proportional())
      release();
    else if (!conjugate_step())
      expand();
    const double violation = largest_violation();
    stalls_ = violation <= rounding() && violation >= least_violation_ / 2 ? stalls_ + 1 : 0;
    least_violation_ = std::min(least_violation_, violation);
    return record();
  }

  const Eigen::VectorXd& clearance() const { return lambda_; }

  bool meets(double tolerance) const { return residuals().largest() <= tolerance || stalls_ >= kMostStalls; }

  /// From now on.
  void compare_with(const BodyState& body) {
    mean_stress_ = body.mean_stress;
    if (body.contact_forces.size() == 0) return;
    lost_ += body.contact_forces - g_;
    refresh();
  }

  /// The conjugate gradients carry g along; this puts an end to what rounding has made of it.
  void refresh() {
    evaluate_gradient();
    begin_anew();
  }

 private:
  ContactResiduals residuals() const {
    return contact_residuals(lambda_, g_.cwiseQuotient(contact_.weight), contact_.weight, mean_stress_);
  }

  /// Of the forces that open unknowns still have, and of what pulls at closed ones.
  double largest_violation() const {
    double largest = 0;
    for (Eigen::Index i = 0; i < g_.size(); ++i)
      largest = std::max(largest, lambda_[i] > 0 ? std::abs(g_[i]) : -g_[i]);
    return largest;
  }

  /// Of S λ − c: no violation below it can be told from it.
  double rounding() const {
    return kRounding *
           (diagonal_.maxCoeff() * lambda_.lpNorm<Eigen::Infinity>() + contact_.c.lpNorm<Eigen::Infinity>());
  }

  /// Of the longest step with which the expansion still never raises the energy.
  static constexpr double kPart = 0.95;

  void evaluate_gradient() { g_ = contact_.force(lambda_, progress_) + lost_; }

  /// Whether what could still be gained on the open part outweighs what closed unknowns gain by opening, both
  /// in the norm of the diagonal.
  bool is_proportional() const {
    double open = 0, closed = 0;
    for (Eigen::Index i = 0; i < g_.size(); ++i) {
      if (lambda_[i] > 0)
        open += std::min(diagonal_[i] * lambda_[i] / step_, g_[i]) * g_[i] / diagonal_[i];
      else if (g_[i] < 0)
        closed += g_[i] * g_[i] / diagonal_[i];
    }
    return closed <= open;
  }

  /// Opens what pulls, as far as the energy falls.
  void release() {
    for (Eigen::Index i = 0; i < g_.size(); ++i)
      direction_[i] = lambda_[i] > 0 ? 0 : std::max(-g_[i], 0.) / diagonal_[i];
    multiply_direction();
    if (is_flat()) throw SingularContact();
    move(-g_.dot(direction_) / curvature_);
    begin_anew();
  }

  /// The longest step along the direction that closes nothing beyond 0.
  double feasible_step() const {
    double longest = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < g_.size(); ++i)
      if (direction_[i] < 0) longest = std::min(longest, -lambda_[i] / direction_[i]);
    return longest;
  }

  /// One step of the conjugate gradients on the open part; false if it ran into λ = 0 on its way, and stopped
  /// there.
  bool conjugate_step() {
    const double descent = -g_.dot(direction_);
    if (descent <= 0) return true;  // nothing is left to gain
    multiply_direction();
    const double most = feasible_step();
    if (is_flat() && std::isinf(most)) throw SingularContact();
    if (is_flat() || descent > most * curvature_) {
      move(most);
      return false;
    }
    move(descent / curvature_);
    precondition();
    direction_ = -z_ + (z_.dot(s_direction_) / curvature_) * direction_;
    return true;
  }

  /// A Uzawa step of what is open.
  void expand() {
    for (Eigen::Index i = 0; i < g_.size(); ++i)
      if (lambda_[i] > 0) lambda_[i] = std::max(0., lambda_[i] - step_ * g_[i] / diagonal_[i]);
    refresh();
  }

  void begin_anew() {
    open_.clear();
    for (int i = 0; i < static_cast<int>(lambda_.size()); ++i)
      if (lambda_[i] > 0) open_.push_back(i);
    scaling_.restrict_to(open_);
    precondition();
    direction_ = -z_;
  }

  void precondition() {
    free_gradient_.setZero(g_.size());
    for (const int i : open_) free_gradient_[i] = g_[i];
    scaling_.apply(free_gradient_, z_);
  }

  void multiply_direction() {
    s_direction_ = symmetric_product(contact_.s, direction_, progress_);
    curvature_ = direction_.dot(s_direction_);
  }

  /// Contact alone may hold the body: along its motion the energy has no curvature.
  bool is_flat() const { return curvature_ <= kRounding * direction_.cwiseAbs2().dot(diagonal_); }

  void move(double length) {
    lambda_ = (lambda_ + length * direction_).cwiseMax(0);
    g_ += length * s_direction_;
  }

  Iteration record() const {
    const ContactResiduals left = residuals();
    Iteration iteration;
    iteration.clearance_change = relative_change(last_, lambda_);
    iteration.penetration = left.penetration;
    iteration.tension = left.tension;
    iteration.complementarity = left.complementarity;
    iteration.active = static_cast<int>((lambda_.array() == 0).count());
    return iteration;
  }

  static constexpr double kRounding = 1e-13;
  static constexpr double kSmallPart = 1e-4;

  const ContactComplement& contact_;
  Progress& progress_;
  const Eigen::VectorXd diagonal_;
  const double step_;
  double mean_stress_;
  Eigen::VectorXd lost_;  ///< what S λ − c lacks of the forces by the stress
  MultilevelScaling scaling_;
  Eigen::VectorXd lambda_, last_, g_;
  std::vector<int> open_;              ///< where the conjugate gradients work
  Eigen::VectorXd free_gradient_, z_;  ///< g there, else 0; B times it
  Eigen::VectorXd direction_, s_direction_;
  double curvature_ = 0;  ///< dᵀ S d
  double least_violation_ = std::numeric_limits<double>::infinity();
  int stalls_ = 0;  ///< iterations among rounding since it was halved
};

}  // namespace

ContactResult mprgp(const ContactComplement& contact, const Mprgp& settings, Progress& progress,
                    const StateOfBody& body, const Eigen::VectorXd& start) {
  Iterate iterate(contact, start, progress);
  const auto converged = [&] { return iterate.meets(settings.tolerance); };
  int looks = 0;
  try {
    while (progress.iterations() < settings.max_iterations) {
      const bool in_time = progress.record(iterate.step());
      if (converged()) {
        iterate.refresh();
        if (converged() && looks++ < kMostLooks) iterate.compare_with(body(iterate.clearance()));
        if (converged()) return {iterate.clearance(), Outcome::converged};
      }
      if (!in_time) return {iterate.clearance(), Outcome::time_limit};
    }
  } catch (const TimeUp&) {
    if (progress.iterations() == 0) throw;
    return {iterate.clearance(), Outcome::time_limit};
  }
  return {iterate.clearance(), Outcome::iteration_limit};
}

}  // namespace signorini
