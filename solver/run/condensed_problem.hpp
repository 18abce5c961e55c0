#pragma once

#include <memory>

#include "contact/active_set.hpp"
#include "contact/condense.hpp"
#include "contact/residuals.hpp"
#include "problem/settings.hpp"
#include "result/summarize.hpp"

namespace signorini {

/// The clearances of the contact problem by a method that works on it alone: not by the paper's form. It
/// begins from the start, clearances ≥ 0, or from 0 if there is none. For `body` see mprgp(). Throws
/// Overflow, and what the method throws.
ContactResult find_clearance(const ContactComplement& contact, const Method& method, Progress& progress,
                             const StateOfBody& body, const Eigen::VectorXd& start = {});

/// A foundation is so far away beside the displacement that its gap would drown it.
bool is_far(const ClearanceSpace& space, double displacement);

class KeptDuals;

/// A problem with everything but the contact unknowns eliminated, by an operator that was kept or is made.
class CondensedProblem {
 public:
  /// Makes the operator on the mesh, or takes one that was kept; and takes one forward solve. Throws
  /// Cancelled, SolveError and what factorize() throws. The problem must outlive it.
  CondensedProblem(const Problem& problem, std::shared_ptr<const Mesh> mesh, Factorization by,
                   Progress& progress);
  CondensedProblem(const Problem& problem, std::shared_ptr<const Operator> kept, Progress& progress);

  const Discretization& discretization() const { return *discretization_; }
  /// It refers to the problem and to the mesh of the operator. Nothing else of this may be used any more.
  std::unique_ptr<Discretization> take_discretization() { return std::move(discretization_); }
  const std::shared_ptr<const Operator>& used_operator() const { return operator_; }
  /// Uses the same operator as a loan of the cache that keeps it now.
  void borrow(std::shared_ptr<const Operator> lent) { operator_ = std::move(lent); }
  const ContactComplement& contact() const { return condensed_->contact(); }

  /// Finds the clearances, beginning as find_clearance() does, and from them all fields. The method is one on
  /// the contact complement, not the paper's form.
  /// A foundation so far away that its gap would drown the displacement is drawn near: a gap that is out of
  /// reach is as good as any other.
  Fields find(const Method& method, Progress& progress, const Eigen::VectorXd& start = {});

  /// The error bound of what was found, and the quantities. `kept`: of the sweep that this is an entry of.
  /// Without one, and if no quantity needs it, lets go of the operator first, for the bound needs none:
  /// nothing but the discretization may be used any more then.
  Certificate certified(const Fields& fields, const Solution& solution, Factorization by, Progress& progress,
                        KeptDuals* kept = nullptr);

  /// Finds the fields, and all that they tell, certified.
  Solution solve(const Settings& settings, Progress& progress, const Eigen::VectorXd& start = {},
                 KeptDuals* kept = nullptr);

 private:
  Fields find_as_posed(const Method& method, Progress& progress, const Eigen::VectorXd& start);
  void condense(Progress& progress);

  std::shared_ptr<const Operator> operator_;
  bool reused_;
  std::unique_ptr<Discretization> discretization_;
  std::unique_ptr<CondensedContact> condensed_;
};

}  // namespace signorini
