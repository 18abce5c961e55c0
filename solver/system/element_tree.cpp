#include "system/element_tree.hpp"

#include <algorithm>
#include <bit>

#include "system/element_sum.hpp"
#include "system/short_cut.hpp"

namespace signorini {
namespace {

/// Elements of a leaf, at least: fewer make the factor sparser, more make its blocks denser.
constexpr int kLeaf = 8;

}  // namespace

ElementTree::ElementTree(const ElementSum& sum, Progress& progress)
    : leaves_(static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, sum.elements() / kLeaf))))) {
  elements_.reserve(sum.matrix_of.size());
  first_element_.reserve(static_cast<std::size_t>(leaves_) + 1);
  std::vector<Centre> centres = centres_of(sum);
  ShortCut halves(sum, leaves_);
  const auto halve = [&](const auto& self, std::span<Centre> elements, int leaves) -> void {
    if (leaves == 1) {
      first_element_.push_back(elements_.size());
      // By where they lie, so that leaves are alike that have the same elements, whatever their numbers.
      std::ranges::sort(elements, {}, [](const Centre& centre) { return centre.at[1]; });
      for (const Centre& centre : elements) elements_.push_back(centre.element);
      return;
    }
    progress.check();
    const std::size_t first_half = halves(elements, leaves);
    self(self, elements.first(first_half), leaves / 2);
    self(self, elements.subspan(first_half), leaves / 2);
  };
  halve(halve, centres, leaves_);
  first_element_.push_back(elements_.size());
}

}  // namespace signorini
