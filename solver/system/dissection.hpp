#pragma once

#include <memory>
#include <span>
#include <vector>

#include "progress/progress.hpp"
#include "system/element_sum.hpp"
#include "system/element_tree.hpp"

namespace signorini {

/// The order of a sparse factorisation by geometric nested dissection (George 1973): of the tree of the
/// elements' pieces, each unknown is eliminated in the smallest piece that holds all its elements, after
/// everything inside the halves of that piece. Trailing unknowns are never eliminated: their piece is 0.
class Dissection {
 public:
  /// By the tree that the sum has, or its own. Throws what Progress throws.
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

  int pieces() const { return tree_->pieces(); }
  bool is_leaf(int piece) const { return tree_->is_leaf(piece); }
  Front front(int piece) const {
    const Place& place = places_[piece];
    return {std::span(unknowns_).subspan(place.first, place.size), place.pivots};
  }
  std::span<const int> elements(int leaf) const { return tree_->elements(leaf); }
  const std::shared_ptr<const ElementTree>& tree() const { return tree_; }

  /// The unknowns of all fronts, and where those of a piece begin among them. Whoever takes them leaves no
  /// fronts.
  std::vector<int> take_unknowns() { return std::move(unknowns_); }
  std::size_t first_unknown(int piece) const { return places_[piece].first; }

  /// Calls visit with every piece, the halves before the whole.
  template <typename Visit>
  void for_each_piece(Visit visit) const {
    for_each_piece([](int) { return true; }, visit);
  }

  /// The same without the pieces that are not wanted and all that they are made of.
  template <typename Wanted, typename Visit>
  void for_each_piece(Wanted is_wanted, Visit visit) const {
    const auto visit_within = [&](const auto& self, int piece) -> void {
      if (!is_wanted(piece)) return;
      if (!is_leaf(piece)) {
        self(self, 2 * piece);
        self(self, 2 * piece + 1);
      }
      visit(piece);
    };
    visit_within(visit_within, 1);
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

  void place_unknowns(const ElementSum& sum, int trailing);
  std::vector<int> unknowns_in(const ElementSum& sum, int leaf) const;
  std::vector<int> left_by_halves(int piece) const;
  bool is_before(int a, int b) const;

  template <typename Visit>
  void visit_outside_in(int piece, Visit& visit) const {
    visit(piece);
    if (is_leaf(piece)) return;
    visit_outside_in(2 * piece + 1, visit);
    visit_outside_in(2 * piece, visit);
  }

  std::shared_ptr<const ElementTree> tree_;
  // Until the fronts are known: the piece of each unknown, and how many unknowns were found before it, leaf
  // by leaf, which of a trailing one is its number.
  std::vector<int> eliminated_in_, found_as_;
  std::vector<Place> places_;  ///< of each piece's front in unknowns_
  std::vector<int> unknowns_;
};

}  // namespace signorini
