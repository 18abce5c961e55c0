#include "system/repeated_pieces.hpp"

#include <numeric>

#include <boost/container_hash/hash.hpp>

namespace signorini {
namespace {

/// Of so many leaves, and of any number more, a half at least are repeated where looking on is worth its
/// time.
constexpr std::size_t kLeaves = 256;

}  // namespace

RepeatedPieces::RepeatedPieces(const Dissection& order, const ElementSum& matrix, Progress& progress)
    : order_(order),
      matrix_(matrix),
      originals_(order.pieces()),
      uses_(order.pieces(), 0),
      row_(matrix.size) {
  std::iota(originals_.begin(), originals_.end(), 0);
  std::size_t leaves = 0, own_leaves = 0;
  bool is_worth_it = true;
  order.for_each_piece([&](int piece) {
    progress.check_in(piece);
    if (is_worth_it) originals_[piece] = find_or_keep(piece);
    if (order.is_leaf(piece)) {
      ++leaves;
      if (is_original(piece)) ++own_leaves;
      is_worth_it = is_worth_it && (leaves < kLeaves || 2 * own_leaves < leaves);
    } else if (is_original(piece)) {
      for (const int half : {2 * piece, 2 * piece + 1}) ++uses_[original(half)];
    }
  });
}

int RepeatedPieces::find_or_keep(int piece) {
  describe(piece, own_);
  const std::size_t hash = boost::hash_range(own_.begin(), own_.end());
  const auto [first, last] = known_.equal_range(hash);
  for (auto known = first; known != last; ++known) {
    describe(known->second, other_);
    if (other_ == own_) return known->second;
  }
  known_.emplace(hash, piece);
  return piece;
}

void RepeatedPieces::describe(int piece, std::vector<int>& description) {
  const Dissection::Front front = order_.front(piece);
  description = {front.size(), front.pivots, order_.is_leaf(piece)};
  for (int k = 0; k < front.size(); ++k) row_[front.unknowns[k]] = k;
  if (order_.is_leaf(piece)) {
    for (const int element : order_.elements(piece)) {
      description.push_back(matrix_.matrix_of[element]);
      for (const int unknown : matrix_.unknowns_of(element))
        description.push_back(unknown < 0 ? unknown : row_[unknown]);
    }
    return;
  }
  for (const int half : {2 * piece, 2 * piece + 1}) {
    description.push_back(original(half));
    for (const int unknown : order_.front(half).remaining()) description.push_back(row_[unknown]);
  }
}

}  // namespace signorini
