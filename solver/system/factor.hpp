#pragma once

#include <cstdlib>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>

#include "progress/progress.hpp"
#include "system/element_tree.hpp"

namespace signorini {

/// The matrix is not positive definite, or not by more than rounding.
struct NotPositiveDefinite : std::runtime_error {
  NotPositiveDefinite();
};

/// The memory for the factor could not be had.
struct OutOfMemory : std::runtime_error {
  OutOfMemory();
};

/// Numbers as malloc() gives them, so that libraries written in C may be whose they were.
struct Free {
  void operator()(void* memory) const { std::free(memory); }
};
using Numbers = std::unique_ptr<double[], Free>;

/// Throws OutOfMemory.
Numbers allocate_numbers(std::size_t count);
/// A matrix of which no number is set. Throws OutOfMemory.
Eigen::MatrixXd unset_square(Eigen::Index size);

/// The columns of a Cholesky factor in the order of the elimination, in dense panels: neighbouring columns
/// with the same rows below their triangle. Panels that are equal may be the same numbers.
struct Panels {
  struct Panel {
    std::size_t first_unknown, first_value;
    int size, pivots;
  };

  /// The rows of a panel: first its pivots, then those unknowns that are eliminated later or never.
  std::span<const int> unknowns_of(const Panel& panel) const {
    return std::span(unknowns).subspan(panel.first_unknown, panel.size);
  }
  /// Its columns, size numbers each, of which those above the diagonal mean nothing.
  const double* columns(const Panel& panel) const { return values.get() + panel.first_value; }

  std::vector<Panel> all;
  std::vector<int> unknowns;
  Numbers values;
  std::size_t count = 0;  ///< of values
};

/// Throws NotPositiveDefinite if what the elimination has left of a pivot of a panel is less than double
/// precision holds: that is rounding, not stiffness. It is compared with its own entry of the matrix'
/// diagonal, so that the units of the unknowns do not matter.
void require_stiffness(std::span<const int> unknowns, int pivots, const double* columns,
                       const std::vector<double>& diagonal);

/// The Cholesky factor of a sparse symmetric positive definite matrix K but for its trailing unknowns.
///
/// With K = [K_II K_IC; K_CI K_CC], C the trailing unknowns, K_II = L Lᵀ is factored, and what that leaves is
/// the complement S = K_CC − K_CI K_II⁻¹ K_IC. A solve splits in two: condense, then expand.
///
/// Solving changes nothing in the factor: any number of threads may do so, each in a workspace of its own. It
/// throws what Progress throws.
class Factor {
 public:
  /// What a solve works in; kept from one solve to the next, it allocates nothing. For one thread at a time.
  struct Workspace {
    Eigen::VectorXd front;
  };

  /// The panels of L, in whose rows stand K_CI L⁻ᵀ too. The tree, if there is one, is that of its dissection.
  Factor(Panels panels, Eigen::MatrixXd complement, std::shared_ptr<const ElementTree> tree = {});

  /// S, in the order of the trailing unknowns.
  const Eigen::MatrixXd& complement() const { return complement_; }

  /// A right side after the forward solve.
  struct Condensed {
    Eigen::VectorXd forward;   ///< L⁻¹ b_I
    Eigen::VectorXd trailing;  ///< b_C − K_CI K_II⁻¹ b_I
  };
  Condensed condense(const Eigen::VectorXd& b, Workspace& workspace, Progress& progress) const;

  /// The unknowns (x_I, x_C) with x_C given and K_II x_I = b_I − K_IC x_C: one backward solve.
  Eigen::VectorXd expand(const Condensed& b, const Eigen::VectorXd& trailing, Workspace& workspace,
                         Progress& progress) const;

  /// x = K⁻¹ b in place, where no unknown is trailing.
  void solve(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;

  const Panels& panels() const { return panels_; }
  /// How the elements were cut into pieces; may be null.
  const std::shared_ptr<const ElementTree>& tree() const { return tree_; }

  /// The memory that it takes.
  std::size_t bytes() const;

 private:
  void forward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;
  void backward(Eigen::VectorXd& x, Workspace& workspace, Progress& progress) const;

  Panels panels_;
  int largest_ = 0;  ///< panel
  Eigen::MatrixXd complement_;
  std::shared_ptr<const ElementTree> tree_;
};

}  // namespace signorini
