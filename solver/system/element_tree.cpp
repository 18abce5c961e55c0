#include "system/element_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "system/short_cut.hpp"

namespace signorini {
namespace {

/// Elements of a leaf, at least: fewer make the factor sparser, more make its blocks denser.
constexpr std::size_t kLeaf = 8;

/// Of the way from one half to the other: what differs by less differs by rounding.
constexpr double kRounding = 1e-9;

/// Whether the second half of a piece is the first, moved: element by element.
bool is_moved(std::span<const Centre> first, std::span<const Centre> second) {
  if (first.size() != second.size()) return false;
  const auto way = [&](std::size_t i, int along) { return second[i].at[along] - first[i].at[along]; };
  const double x = way(0, 0), y = way(0, 1), rounding = kRounding * (std::abs(x) + std::abs(y));
  for (std::size_t i = 0; i < first.size(); ++i)
    if (std::abs(way(i, 0) - x) > rounding || std::abs(way(i, 1) - y) > rounding) return false;
  return true;
}

/// Sorts the elements leaf by leaf.
class Halving {
 public:
  Halving(const SharedNumbers& shared, int elements, int leaves, Progress& progress)
      : progress_(progress), halves_(shared, elements, leaves), place_(elements) {}

  void operator()(std::span<Centre> elements, int leaves) {
    if (leaves == 1) {
      // By where they lie, so that leaves are alike that have the same elements, whatever their numbers.
      std::ranges::sort(elements, {}, [](const Centre& centre) { return centre.at[1]; });
      of_leaf_.push_back(elements.size());
      return;
    }
    progress_.check();
    const std::size_t first_half = halves_(elements, leaves);
    const std::span<Centre> first = elements.first(first_half), second = elements.subspan(first_half);
    if (first_half >= kWorthALook && is_moved(first, second)) return halve_alike(first, second, leaves / 2);
    (*this)(first, leaves / 2);
    (*this)(second, leaves / 2);
  }

  /// The numbers of elements of each leaf.
  const std::vector<std::size_t>& of_leaf() const { return of_leaf_; }

 private:
  /// Elements of a half.
  static constexpr std::size_t kWorthALook = 2 * kLeaf;

  /// The second half becomes what the first one does.
  void halve_alike(std::span<Centre> first, std::span<Centre> second, int leaves) {
    std::vector<int> before;
    for (const Centre& centre : first) before.push_back(centre.element);
    const std::vector<Centre> moved(second.begin(), second.end());
    const std::size_t first_leaf = of_leaf_.size();
    (*this)(first, leaves);
    for (std::size_t i = 0; i < before.size(); ++i) place_[before[i]] = static_cast<int>(i);
    for (std::size_t i = 0; i < second.size(); ++i) second[i] = moved[place_[first[i].element]];
    const std::size_t behind = of_leaf_.size();
    for (std::size_t leaf = first_leaf; leaf < behind; ++leaf) of_leaf_.push_back(of_leaf_[leaf]);
  }

  Progress& progress_;
  ShortCut halves_;
  std::vector<int> place_;  ///< of an element in a half, before that was sorted
  std::vector<std::size_t> of_leaf_;
};

}  // namespace

ElementTree::ElementTree(const std::vector<Point>& centres, const SharedNumbers& shared, Progress& progress)
    : leaves_(static_cast<int>(std::bit_floor(std::max<std::size_t>(1, centres.size() / kLeaf)))) {
  std::vector<Centre> sorted = tilted(centres);
  Halving halve(shared, static_cast<int>(centres.size()), leaves_, progress);
  halve(sorted, leaves_);
  elements_.reserve(sorted.size());
  for (const Centre& centre : sorted) elements_.push_back(centre.element);
  first_element_.reserve(static_cast<std::size_t>(leaves_) + 1);
  first_element_.push_back(0);
  for (const std::size_t count : halve.of_leaf()) first_element_.push_back(first_element_.back() + count);
}

std::shared_ptr<const ElementTree> tree_by_edges(const std::vector<Point>& centres,
                                                 std::span<const std::array<int, 3>> edges_of_triangles,
                                                 Progress& progress) {
  SharedNumbers edges{{}, 3, 0};
  if (!edges_of_triangles.empty()) {
    edges.all = {edges_of_triangles.front().data(), 3 * edges_of_triangles.size()};
    edges.size = *std::ranges::max_element(edges.all) + 1;
  }
  return std::make_shared<const ElementTree>(centres, edges, progress);
}

}  // namespace signorini
