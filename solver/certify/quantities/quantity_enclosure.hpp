#pragma once

#include "certify/data/law_pieces.hpp"
#include "certify/quantities/certified_solution.hpp"
#include "problem/quantity.hpp"

namespace signorini {

/// Encloses quantities of a solution by the solutions of neighbouring problems: THEORY.md, Theorem 4.
class QuantityEnclosure {
 public:
  /// All must outlive it.
  QuantityEnclosure(const CertifiedSolution& base, const LawOnMesh& laws, Progress& progress);

  /// R of THEORY.md, Theorem 1: twice a bound of ‖σ − ½ (σ* + E ε(v))‖_C.
  double radius() const { return radius_; }

  struct Bounds {
    double lower, upper;
    double way;  ///< x of Theorem 4, the larger one of both ends
    /// By triangles, the products of the errors that the width is made of, up to a factor.
    Eigen::VectorXd shares;
  };
  /// `plus`, `minus`: of neighbour(problem, quantity, ±z), z > 0.
  Bounds operator()(const Quantity& quantity, const CertifiedSolution& plus, const CertifiedSolution& minus,
                    double z) const;
  /// The same where 2 base − plus will do as `minus`: is_admissible_reflected().
  Bounds reflected(const Quantity& quantity, const CertifiedSolution& plus, double z) const;

 private:
  /// What v and σ* of a solution count in a sum.
  struct Term {
    double of_displacement, of_stress;
    const CertifiedSolution& solution;

    Term operator+(double more) const { return {of_displacement + more, of_stress + more, solution}; }
  };

  /// Of the fields that several pairs add up to.
  struct Sums {
    Eigen::VectorXd gaps;  ///< ‖C σ* − ε(v)‖²_E by triangles, from above
    double gap = 0;
    double strain = 0, energy = 0;  ///< as in TriangleSums
    double slack = 0, energy_slack = 0;
  };

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

  template <int D>
  Sums sums_of(const Discretization& loads, const std::vector<Term>& terms) const;
  Sums sums(const Discretization& loads, const std::vector<Term>& terms) const;
  Known work_of_traction(const Discretization& loads, const AdmissibleDisplacement& v) const;
  Known work_of_loads(const Discretization& loads, const Sums& of_v) const;
  Known contact_work(const CertifiedSolution& of_pressure) const;
  double unbalanced_between(const CertifiedSolution& other, bool have_same_loads, Eigen::VectorXd& o) const;
  Known along(const Quantity& quantity, const Term& start, const Term& of_stress, const Term& of_displacement,
              double& way, Eigen::VectorXd& shares) const;

  const CertifiedSolution& base_;
  const LawOnMesh& laws_;
  Progress& progress_;
  const std::vector<int> everywhere_;  ///< all triangles have an owner
  Sums own_;
  Known contact_;
  double radius_;
};

}  // namespace signorini
