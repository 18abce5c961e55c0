#include "system/dissection.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <limits>

namespace signorini {
namespace {

/// The smallest piece around two leaves.
int piece_around(int a, int b) {
  return a >> std::bit_width(static_cast<unsigned>(a ^ b));
}

}  // namespace

Dissection::Dissection(const ElementSum& sum, int trailing, Progress& progress)
    : tree_(sum.tree ? sum.tree
                     : std::make_shared<const ElementTree>(
                           sum.centres, SharedNumbers{sum.unknowns, sum.per_element, sum.size}, progress)),
      places_(tree_->pieces()) {
  place_unknowns(sum, trailing);
  for_each_piece([&](int piece) {
    progress.check_in(piece);
    const std::vector<int> gathered = is_leaf(piece) ? unknowns_in(sum, piece) : left_by_halves(piece);
    const auto pivots = std::ranges::count(gathered, piece, [&](int i) { return eliminated_in_[i]; });
    places_[piece] = {unknowns_.size(), static_cast<int>(gathered.size()), static_cast<int>(pivots)};
    unknowns_.insert(unknowns_.end(), gathered.begin(), gathered.end());
  });
  unknowns_.shrink_to_fit();  // for they stay as long as the factor does
  eliminated_in_ = {};
  found_as_ = {};
}

void Dissection::place_unknowns(const ElementSum& sum, int trailing) {
  std::vector<int> first_leaf(sum.size, std::numeric_limits<int>::max()), last_leaf(sum.size, -1);
  found_as_.assign(sum.size, sum.size);
  int found = 0;
  for (int leaf = tree_->leaves(); leaf < tree_->pieces(); ++leaf)
    for (const int element : elements(leaf))
      for (const int unknown : sum.unknowns_of(element))
        if (unknown >= 0) {
          if (last_leaf[unknown] < 0) found_as_[unknown] = found++;
          first_leaf[unknown] = std::min(first_leaf[unknown], leaf);
          last_leaf[unknown] = leaf;
        }
  constexpr int whole = 1, outside = 0;
  eliminated_in_.assign(sum.size, outside);
  for (int i = 0; i < sum.size - trailing; ++i)
    eliminated_in_[i] = last_leaf[i] < 0 ? whole : piece_around(first_leaf[i], last_leaf[i]);
  for (int i = sum.size - trailing; i < sum.size; ++i) found_as_[i] = i;
}

/// Whether one unknown of a front is eliminated before another: the pieces that eliminate them are around one
/// another, so the one of the larger number lies inside. In one piece they go as they are found, whatever
/// their numbers: so pieces are alike that have the same elements.
bool Dissection::is_before(int a, int b) const {
  return eliminated_in_[a] != eliminated_in_[b] ? eliminated_in_[a] > eliminated_in_[b]
                                                : found_as_[a] < found_as_[b];
}

std::vector<int> Dissection::unknowns_in(const ElementSum& sum, int leaf) const {
  std::vector<int> found;
  for (const int element : elements(leaf))
    std::ranges::copy_if(sum.unknowns_of(element), std::back_inserter(found), [](int i) { return i >= 0; });
  std::ranges::sort(found, [this](int a, int b) { return is_before(a, b); });
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::vector<int> Dissection::left_by_halves(int piece) const {
  std::vector<int> found;
  std::ranges::set_union(front(2 * piece).remaining(), front(2 * piece + 1).remaining(),
                         std::back_inserter(found), [this](int a, int b) { return is_before(a, b); });
  return found;
}

}  // namespace signorini
