#pragma once

#include <span>
#include <vector>

#include "progress/progress.hpp"
#include "system/element_sum.hpp"

namespace signorini {

/// The order of a sparse factorisation by geometric nested dissection (George 1973): the elements are cut
/// into two halves that share few unknowns (system/short_cut.hpp), and the halves again, until a piece has a
/// few; an unknown is eliminated in the smallest piece that holds all its elements, after everything inside
/// the halves of that piece. Trailing unknowns are never eliminated.
///
/// The pieces are a complete binary tree, numbered as in a heap: 1 is the whole, 2 k and 2 k + 1 are the
/// halves of k, and 0 stands outside, for what is never eliminated.
class Dissection {
 public:
  /// Throws what Progress throws.
  Dissection(const ElementSum& sum, int trailing, Progress& progress);

  /// The unknowns that a piece couples when all inside it are eliminated: first the pivots, which it
  /// eliminates, then those that pieces around it do, from the nearest outwards.
  struct Front {
    std::span<const int> unknowns;
    int pivots;

    int size() const { return static_cast<int>(unknowns.size()); }
    int rest() const { return size() - pivots; }
    std::span<const int> remaining() const { return unknowns.subspan(pivots); }
  };

  int pieces() const { return 2 * leaves_; }  ///< one more than the largest number
  bool is_leaf(int piece) const { return piece >= leaves_; }
  Front front(int piece) const {
    const Place& place = places_[piece];
    return {std::span(unknowns_).subspan(place.first, place.size), place.pivots};
  }
  /// The elements of a leaf.
  std::span<const int> elements(int leaf) const {
    const std::size_t first = first_element_[leaf - leaves_];
    return std::span(elements_).subspan(first, first_element_[leaf - leaves_ + 1] - first);
  }

  /// The unknowns of all fronts, and where those of a piece begin among them. Whoever takes them leaves no
  /// fronts.
  std::vector<int> take_unknowns() { return std::move(unknowns_); }
  std::size_t first_unknown(int piece) const { return places_[piece].first; }

  /// Calls visit with every piece, the halves before the whole.
  template <typename Visit>
  void for_each_piece(Visit visit) const {
    visit_inside_out(1, visit);
  }

  /// The other way round: the whole before its halves.
  template <typename Visit>
  void for_each_piece_outside_in(Visit visit) const {
    visit_outside_in(1, visit);
  }

 private:
  struct Place {
    std::size_t first = 0;
    int size = 0, pivots = 0;
  };

  void cut(const ElementSum& sum, Progress& progress);
  void place_unknowns(const ElementSum& sum, int trailing);
  std::vector<int> unknowns_in(const ElementSum& sum, int leaf) const;
  std::vector<int> left_by_halves(int piece) const;
  bool is_before(int a, int b) const;

  template <typename Visit>
  void visit_inside_out(int piece, Visit& visit) const {
    if (!is_leaf(piece)) {
      visit_inside_out(2 * piece, visit);
      visit_inside_out(2 * piece + 1, visit);
    }
    visit(piece);
  }

  template <typename Visit>
  void visit_outside_in(int piece, Visit& visit) const {
    visit(piece);
    if (is_leaf(piece)) return;
    visit_outside_in(2 * piece + 1, visit);
    visit_outside_in(2 * piece, visit);
  }

  int leaves_ = 1;
  std::vector<int> elements_;               ///< leaf by leaf
  std::vector<std::size_t> first_element_;  ///< of each leaf, and behind the last
  std::vector<int> eliminated_in_;          ///< the piece of each unknown
  std::vector<Place> places_;               ///< of each piece's front in unknowns_
  std::vector<int> unknowns_;
};

}  // namespace signorini
