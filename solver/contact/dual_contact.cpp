#include "contact/dual_contact.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "progress/progress.hpp"
#include "system/dense_cholesky.hpp"

namespace signorini {
namespace {

/// A force below this part of the largest is rounding.
constexpr double kNoForce = 1e-12;

/// Whenever a force is held at its bound, others may grow beyond theirs.
constexpr int kTries = 3;

class LinearContact {
 public:
  LinearContact(const ContactComplement& base, const Eigen::VectorXd& clearance, const Eigen::VectorXd& c,
                Progress& progress)
      : base_(base),
        progress_(progress),
        force_(base.force(clearance, progress)),
        dual_{base.s, c, base.weight},
        given_(Eigen::VectorXd::Zero(base.size())),
        is_given_(base.size(), false) {
    const double most = force_.size() > 0 ? force_.maxCoeff() : 0;
    for (Eigen::Index i = 0; i < base.size(); ++i)
      is_given_[i] = clearance[i] > 0 || force_[i] <= kNoForce * most;
  }

  /// Where forces are given as is_open says; false if they do not hold the body.
  bool solve() {
    std::vector<int> open;
    for (int i = 0; i < static_cast<int>(is_given_.size()); ++i)
      if (is_given_[i]) open.push_back(i);
    const DenseCholesky factor(base_.s, open, progress_);
    constexpr double singular = 1e-12;
    if (!factor.is_positive_definite() || factor.smallest_pivot() < singular * factor.largest_pivot())
      return false;
    const Eigen::VectorXd right = dual_.c + given_, found = factor.solve(right(open), progress_);
    own_ = Eigen::VectorXd::Zero(dual_.size());
    for (std::size_t k = 0; k < open.size(); ++k) own_[open[k]] = found[static_cast<Eigen::Index>(k)];
    own_force_ = dual_.force(own_, progress_);
    open_ = std::move(open);
    return true;
  }

  /// What the force is of that of the base at most, where it is not given.
  double largest_factor() const {
    double most = 0;
    for (Eigen::Index i = 0; i < dual_.size(); ++i)
      if (!is_given_[i]) most = std::max(most, std::abs(own_force_[i]) / force_[i]);
    return most;
  }

  /// Holds the forces that are larger; false if there are none.
  bool hold(double factor) {
    bool is_any = false;
    for (Eigen::Index i = 0; i < dual_.size(); ++i)
      if (!is_given_[i] && std::abs(own_force_[i]) > factor * force_[i]) {
        given_[i] = std::copysign(factor * force_[i], own_force_[i]);
        is_any = is_given_[i] = true;
      }
    return is_any;
  }

  DualContact take() {
    std::erase_if(open_, [this](int i) { return given_[i] != 0; });
    const double most = largest_factor();
    return {std::move(own_), std::move(open_), most};
  }

 private:
  const ContactComplement& base_;
  Progress& progress_;
  const Eigen::VectorXd force_;
  const ContactComplement dual_;
  Eigen::VectorXd given_, own_, own_force_;
  std::vector<bool> is_given_;
  std::vector<int> open_;
};

}  // namespace

DualContact dual_contact(const ContactComplement& base, const Eigen::VectorXd& clearance,
                         const Eigen::VectorXd& c, double factor, Progress& progress) {
  LinearContact linear(base, clearance, c, progress);
  if (!linear.solve()) throw SingularContact();
  for (int tries = 0; tries < kTries && linear.hold(factor); ++tries)
    if (!linear.solve()) break;
  return linear.take();
}

}  // namespace signorini
