#pragma once

#include <map>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

namespace signorini {

/// A linear function of unknowns, by the numbers of those that it depends on.
using LinearForm = std::vector<std::pair<int, double>>;

/// Unknowns x with row·x = 0 for some rows, as combinations of those that are left free.
class FreeUnknowns {
 public:
  /// Another row. One that depends on those before it is no harm.
  void take_away(const LinearForm& row);

  /// The sparse columns whose combinations are all such x, by columns what a free unknown changes.
  Eigen::SparseMatrix<double> basis(int unknowns) const;

 private:
  using Combination = std::map<int, double>;

  void add(double times, const Combination& some, int to, Combination& sum);

  std::map<int, Combination> known_;
  std::map<int, std::vector<int>> users_;  ///< of a free unknown: known ones that may depend on it
};

}  // namespace signorini
