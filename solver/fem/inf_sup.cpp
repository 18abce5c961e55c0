#include "fem/inf_sup.hpp"

#include <cmath>
#include <optional>
#include <string>

#include <Spectra/SymGEigsShiftSolver.h>

#include "fem/sparse_ldlt.hpp"

namespace signorini {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Map = Eigen::Map<Eigen::VectorXd>;
using ConstMap = Eigen::Map<const Eigen::VectorXd>;

/// y = M x for x = (v, γ, μ): the norm of μ is that of its least extension w.
class NormProduct {
 public:
  using Scalar = double;  // Spectra asks for it

  NormProduct(const InfSupForms& forms, Progress& progress)
      : n_(forms.multipliers),
        norms_(of_all_but_stress(forms)),
        extension_(norms_.bottomRightCorner(forms.extensions, forms.extensions), progress),
        progress_(progress) {}

  Eigen::Index rows() const { return n_; }
  Eigen::Index cols() const { return n_; }
  void perform_op(const double* x, double* y) const {
    Eigen::VectorXd extended = Eigen::VectorXd::Zero(norms_.rows());
    extended.head(n_) = ConstMap(x, n_);
    const Eigen::Index w = norms_.rows() - n_;
    extended.tail(w) =
        -extension_.solve((norms_.selfadjointView<Eigen::Lower>() * extended).tail(w), progress_);
    Map(y, n_) = (norms_.selfadjointView<Eigen::Lower>() * extended).head(n_);
  }

 private:
  static Sparse of_all_but_stress(const InfSupForms& forms) {
    const int size = forms.multipliers + forms.extensions;
    return forms.norms.bottomRightCorner(size, size);
  }

  Eigen::Index n_;
  Sparse norms_;
  SparseLdlt extension_;
  Progress& progress_;
};

/// y = (B A⁻¹ Bᵀ − s M)⁻¹ x for s < 0: the solution of
///
///     [ A   Bᵀ  ] [σ]   [ 0 ]
///     [ B  s M  ] [y] = [−x ],
///
/// whose matrix, with w as a field of its own, has L D Lᵀ in every order (Vanderbei 1995, quasi-definite).
class ShiftedInverse {
 public:
  using Scalar = double;

  ShiftedInverse(const InfSupForms& forms, Progress& progress) : forms_(forms), progress_(progress) {}

  Eigen::Index rows() const { return forms_.multipliers; }
  Eigen::Index cols() const { return forms_.multipliers; }
  void set_shift(double shift) {
    try {
      factor_.emplace(forms_.coupled + shift * forms_.norms, progress_);
    } catch (const SingularPivot& singular) {
      throw SolveError(std::string("the inf-sup constant cannot be computed, as ") + singular.what() +
                       ": take another mesh");
    }
  }
  void perform_op(const double* x, double* y) const {
    Eigen::VectorXd load = Eigen::VectorXd::Zero(forms_.coupled.rows());
    load.segment(forms_.stresses, rows()) = -ConstMap(x, rows());
    Map(y, rows()) = factor_->solve(load, progress_).segment(forms_.stresses, rows());
  }

 private:
  const InfSupForms& forms_;
  Progress& progress_;
  std::optional<SparseLdlt> factor_;
};

/// The shift is far below the square of any constant of use, so that the least eigenvalue is found soon, and
/// far above rounding, so that one of zero is found at all.
constexpr double kShift = -1e-3, kEigenTolerance = 1e-6;
constexpr Eigen::Index kBasis = 20, kRestarts = 300;

/// The least θ with B A⁻¹ Bᵀ x = θ M x.
double least_eigenvalue(ShiftedInverse& inverse, NormProduct& norms) {
  if (norms.rows() == 1) {
    double x = 1;
    inverse.set_shift(kShift);
    norms.perform_op(&x, &x);
    inverse.perform_op(&x, &x);
    return 1 / x + kShift;
  }
  Spectra::SymGEigsShiftSolver<ShiftedInverse, NormProduct, Spectra::GEigsMode::ShiftInvert> lanczos(
      inverse, norms, 1, std::min(norms.rows(), kBasis), kShift);
  lanczos.init();
  lanczos.compute(Spectra::SortRule::LargestMagn, kRestarts, kEigenTolerance);
  if (lanczos.info() != Spectra::CompInfo::Successful)
    throw SolveError("the inf-sup constant was not found by its iteration: take another mesh");
  return lanczos.eigenvalues()[0];
}

}  // namespace

double inf_sup_constant(const Problem& problem, const Mesh& mesh, Progress& progress, Bubbles bubbles) {
  const InfSupForms forms = inf_sup_forms(problem, mesh, bubbles, progress);
  NormProduct norms(forms, progress);
  ShiftedInverse inverse(forms, progress);
  return std::sqrt(std::max(0., least_eigenvalue(inverse, norms)));
}

}  // namespace signorini
