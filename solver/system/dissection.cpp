#include "system/dissection.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>

#include <Eigen/Geometry>

namespace signorini {
namespace {

/// Elements of a leaf, at least: fewer make the factor sparser, more make its blocks denser.
constexpr int kLeaf = 8;

struct Centre {
  Point at;
  int element;
};

/// How far the middle half of the centres, of up to 63 of them, is spread along an axis.
template <typename Iterator>
double spread(Iterator begin, Iterator end, int axis) {
  constexpr std::ptrdiff_t most = 63;
  const std::ptrdiff_t size = std::min(most, end - begin);
  std::array<double, most> sample;
  // In no step with the rows of a structured mesh.
  constexpr double golden = 0.6180339887498949;
  for (std::ptrdiff_t i = 0; i < size; ++i) {
    const double place = (static_cast<double>(i) + 0.5) * golden;
    sample[i] =
        begin[static_cast<std::ptrdiff_t>((place - std::floor(place)) * static_cast<double>(end - begin))]
            .at[axis];
  }
  const auto quartile = sample.begin() + size / 4, other = sample.begin() + size - 1 - size / 4;
  std::nth_element(sample.begin(), quartile, sample.begin() + size);
  std::nth_element(quartile, other, sample.begin() + size);
  return *other - *quartile;
}

/// The axis along which the elements lie: that of the longer extent, unless most of a large piece lie in a
/// place that is narrow there, where a cut would be as long as the place.
template <typename Iterator>
int axis_of(Iterator begin, Iterator end) {
  constexpr std::ptrdiff_t large = 256;
  constexpr double narrow = 0.25;
  Eigen::AlignedBox2d box;
  for (auto centre = begin; centre != end; ++centre) box.extend(centre->at);
  const int longer = box.sizes().x() >= box.sizes().y() ? 0 : 1;
  const bool misled =
      end - begin > large && spread(begin, end, longer) < narrow * spread(begin, end, 1 - longer);
  return misled ? 1 - longer : longer;
}

/// The smallest piece around two leaves.
int piece_around(int a, int b) {
  return a >> std::bit_width(static_cast<unsigned>(a ^ b));
}

}  // namespace

Dissection::Dissection(const ElementSum& sum, int trailing, Progress& progress)
    : leaves_(static_cast<int>(std::bit_floor(static_cast<unsigned>(std::max(1, sum.elements() / kLeaf))))),
      places_(2 * leaves_) {
  cut(sum, progress);
  place_unknowns(sum, trailing);
  for_each_piece([&](int piece) {
    progress.check_in(piece);
    const std::vector<int> gathered = is_leaf(piece) ? unknowns_in(sum, piece) : left_by_halves(piece);
    const auto pivots = std::ranges::count(gathered, piece, [&](int i) { return eliminated_in_[i]; });
    places_[piece] = {unknowns_.size(), static_cast<int>(gathered.size()), static_cast<int>(pivots)};
    unknowns_.insert(unknowns_.end(), gathered.begin(), gathered.end());
  });
}

std::size_t Dissection::first_element(int leaf) const {
  return elements_.size() * static_cast<std::size_t>(leaf - leaves_) / static_cast<std::size_t>(leaves_);
}

/// Sorts the elements so that those of every piece are neighbours.
void Dissection::cut(const ElementSum& sum, Progress& progress) {
  elements_.resize(sum.elements());
  std::vector<Centre> centres(sum.elements());
  for (int e = 0; e < sum.elements(); ++e) centres[e] = {sum.centres[e], e};
  const auto halve = [&](const auto& self, int first_leaf, int leaves) -> void {
    if (leaves == 1) return;
    progress.check();
    const auto at = [&](int leaf) {
      return centres.begin() + static_cast<std::ptrdiff_t>(first_element(leaf));
    };
    const auto begin = at(first_leaf), middle = at(first_leaf + leaves / 2), end = at(first_leaf + leaves);
    const int along = axis_of(begin, end), across = 1 - along;
    std::nth_element(begin, middle, end, [&](const Centre& a, const Centre& b) {
      return a.at[along] != b.at[along] ? a.at[along] < b.at[along] : a.at[across] < b.at[across];
    });
    self(self, first_leaf, leaves / 2);
    self(self, first_leaf + leaves / 2, leaves / 2);
  };
  halve(halve, leaves_, leaves_);
  for (int e = 0; e < sum.elements(); ++e) elements_[e] = centres[e].element;
}

void Dissection::place_unknowns(const ElementSum& sum, int trailing) {
  std::vector<int> first_leaf(sum.size, std::numeric_limits<int>::max()), last_leaf(sum.size, -1);
  for (int leaf = leaves_; leaf < 2 * leaves_; ++leaf)
    for (const int element : elements(leaf))
      for (const int unknown : sum.unknowns_of(element))
        if (unknown >= 0) {
          first_leaf[unknown] = std::min(first_leaf[unknown], leaf);
          last_leaf[unknown] = leaf;
        }
  constexpr int whole = 1, outside = 0;
  eliminated_in_.assign(sum.size, outside);
  for (int i = 0; i < sum.size - trailing; ++i)
    eliminated_in_[i] = last_leaf[i] < 0 ? whole : piece_around(first_leaf[i], last_leaf[i]);
}

/// Whether one unknown of a front is eliminated before another: the pieces that eliminate them are around one
/// another, so the one of the larger number lies inside.
bool Dissection::is_before(int a, int b) const {
  return eliminated_in_[a] != eliminated_in_[b] ? eliminated_in_[a] > eliminated_in_[b] : a < b;
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
