#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "fem/discretization.hpp"
#include "problem/settings.hpp"
#include "system/element_sum.hpp"
#include "system/factor.hpp"

namespace signorini {

/// What a solve works out before it looks at the data: the mesh, and the Cholesky factor of the hybrid
/// system's K with the contact complement S. It depends on the domain and its mesh, the material, the kinds
/// of the conditions and the scheme, but not on gaps, loads, tractions and boundary values, nor on the
/// method: it is a value that can be kept. Nothing changes it, so that any number of threads may use it.
class Operator {
 public:
  /// Factors the matrix of the problem on its mesh. Throws NotPositiveDefinite unless contact alone holds the
  /// body: then S is only semidefinite. Throws what factorize() throws besides.
  Operator(std::shared_ptr<const Mesh> mesh, const ClearanceSpace& space, const ElementSum& matrix,
           bool held_by_contact_alone, Factorization by, Progress& progress);

  const Mesh& mesh() const { return *mesh_; }
  const std::shared_ptr<const Mesh>& shared_mesh() const { return mesh_; }
  const Factor& factor() const { return factor_; }
  const Eigen::MatrixXd& complement() const { return factor_.complement(); }  ///< S
  const Eigen::VectorXd& weight() const { return weight_; }  ///< <1, φ_i> of the contact unknowns

  /// The memory that it takes.
  std::size_t bytes() const;

 private:
  std::shared_ptr<const Mesh> mesh_;
  Factor factor_;
  Eigen::VectorXd weight_;
};

/// Where operators are kept from one solve to the next. Keys are `Problem::operator_key`. Implementations
/// may forget any of them at any time.
class OperatorCache {
 public:
  virtual ~OperatorCache() = default;

  /// The operator kept under the key, or null.
  virtual std::shared_ptr<const Operator> find(const std::string& key) = 0;
  /// False if it is not kept. What is forgotten on the way is freed unmetered.
  virtual bool keep(const std::string& key, std::shared_ptr<const Operator> made) = 0;
};

/// An operator of a cache in the hands of a solve, which meters its memory: what it lets go of is not freed
/// but left to the cache, or freed in its place. That of one which the solve has made is the solve's until
/// then.
enum class MadeBy { this_solve, another };
std::shared_ptr<const Operator> on_loan(std::shared_ptr<const Operator> kept, MadeBy made_by);

}  // namespace signorini
