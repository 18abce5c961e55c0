#pragma once

#include "certify/data/law_pieces.hpp"
#include "certify/pair_sums.hpp"
#include "certify/quantities/certified_solution.hpp"
#include "problem/quantity.hpp"

namespace signorini {

class ShapeNorms;

/// Encloses quantities of a solution by the solutions of their dual problems: THEORY.md, Theorem 4.
class QuantityEnclosure {
 public:
  /// `sums`: of the base. All else must outlive it.
  QuantityEnclosure(const CertifiedSolution& base, PairSums sums, const LawOnMesh& laws, ShapeNorms& norms,
                    Progress& progress);

  /// R of THEORY.md, Theorem 1: twice a bound of ‖σ − ½ (σ* + E ε(v))‖_C.
  double radius() const { return radius_; }

  struct Bounds {
    double lower, upper;
    double free_factor;  ///< x / R, up to which K costs nothing
    double factor;       ///< K
    /// By triangles, the products of the errors that the width is made of, up to a factor.
    Eigen::VectorXd shares;
  };
  /// `dual`: of dual_problem(), with its dual_pair() beside that of the base. `size`: about how many times
  /// the base is larger than it, so that no digits are lost where both are added up.
  Bounds operator()(const CertifiedSolution& dual, double size) const;

 private:
  /// A value and what it may be off by.
  struct Known {
    double value = 0, radius = 0;
    Known& operator+=(const Known& other) {
      value += other.value;
      radius += other.radius;
      return *this;
    }
  };
  friend Known operator*(double factor, const Known& known) {
    return {factor * known.value, std::abs(factor) * known.radius};
  }

  /// What a solution counts in a sum.
  struct Term {
    double factor;
    const CertifiedSolution& solution;
  };

  template <int D>
  PairSums sums_of(const std::vector<Term>& terms) const;
  PairSums sums(const std::vector<Term>& terms) const;
  Known work_of_traction(const Discretization& loads, const AdmissibleDisplacement& v) const;
  Known contact_work(const ContactPressure& pressure) const;
  double beyond_base(const CertifiedSolution& dual) const;
  double largest_rest(double x, double factor) const;

  const CertifiedSolution& base_;
  const LawOnMesh& laws_;
  ShapeNorms& norms_;
  Progress& progress_;
  const std::vector<int> everywhere_;  ///< all triangles have an owner
  const PairSums own_;
  Known contact_;
  double radius_;
};

}  // namespace signorini
