#pragma once

#include <span>
#include <unordered_map>
#include <vector>

#include "progress/progress.hpp"
#include "system/dissection.hpp"

namespace signorini {

/// Which pieces of a dissection have the same front. On a mesh of squares with one material nearly all do: a
/// thousand leaves differ in nothing but the numbers of their unknowns. Of those only the first, the
/// original, need be eliminated.
///
/// Leaves are alike if their elements have the same matrices and the same rows of the front in the same
/// order; other pieces, if their halves are alike and leave the same rows. So equal fronts are sums of the
/// same numbers in the same order: what an elimination makes of them is equal to the last bit.
class RepeatedPieces {
 public:
  /// Throws what Progress throws.
  RepeatedPieces(const Dissection& order, const ElementSum& matrix, Progress& progress);

  /// The first piece with the same front, in the order of the elimination.
  int original(int piece) const { return originals_[piece]; }
  bool is_original(int piece) const { return originals_[piece] == piece; }
  /// By so many originals is taken in what an original leaves.
  int uses(int original) const { return uses_[original]; }

 private:
  /// What tells the front of a piece from others: see above.
  void describe(int piece, std::vector<int>& description);
  int find_or_keep(int piece);

  const Dissection& order_;
  const ElementSum& matrix_;
  std::vector<int> originals_, uses_;
  std::unordered_multimap<std::size_t, int> known_;  ///< originals by the hash of their description
  std::vector<int> row_;                             ///< in the front of a piece, of each of its unknowns
  std::vector<int> own_, other_;                     ///< descriptions
};

}  // namespace signorini
