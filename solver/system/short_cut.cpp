#include "system/short_cut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace signorini {
namespace {

/// So many times as long as one between squares may be a cut that is as good as any. On an even number of
/// squares it has once their length.
constexpr double kOfSquares = 1.25;

/// Extents that differ by less differ by rounding: pieces that are alike are to be cut alike.
constexpr double kLonger = 1 + 1e-9;

/// The least part of the elements that a half has.
constexpr double kLeastHalf = 0.3;

Eigen::Vector2d extents(std::span<const Centre> piece) {
  Eigen::AlignedBox2d box;
  for (const Centre& centre : piece) box.extend(Point(centre.at[0], centre.at[1]));
  return box.sizes();
}

auto before(int along) {
  return [along](const Centre& a, const Centre& b) { return a.at[along] < b.at[along]; };
}

void divide(std::span<Centre> piece, std::size_t first_half, int along) {
  std::nth_element(piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(first_half), piece.end(),
                   before(along));
}

}  // namespace

std::vector<Centre> centres_of(const ElementSum& sum) {
  Eigen::AlignedBox2d box;
  for (const Point& centre : sum.centres) box.extend(centre);
  const Eigen::Vector2d sizes = box.sizes();
  // Across columns of squares x varies by much more, even if there are a million.
  constexpr double tilt = 1e-8;
  const double of_x = sizes.y() > 0 ? tilt * sizes.x() / sizes.y() : 0,
               of_y = sizes.x() > 0 ? tilt * sizes.y() / sizes.x() : 0;
  std::vector<Centre> centres;
  centres.reserve(sum.centres.size());
  for (int e = 0; e < sum.elements(); ++e) {
    const Point own = sum.centres[e] - box.min();
    centres.push_back({{own.x() + of_x * own.y(), own.y() + of_y * own.x()}, e});
  }
  return centres;
}

ShortCut::ShortCut(const ElementSum& sum, int leaves)
    : sum_(sum),
      elements_per_leaf_(static_cast<double>(sum.elements()) / leaves),
      per_side_(static_cast<double>(std::ranges::count_if(sum.unknowns, [](int i) { return i >= 0; })) /
                (3. * sum.elements())),
      seen_as_(sum.size, 0),
      first_(sum.size),
      last_(sum.size) {}

std::size_t ShortCut::operator()(std::span<Centre> piece, int leaves) {
  const std::size_t middle = piece.size() / 2;
  const Eigen::Vector2d extent = extents(piece);
  const int longer = extent.y() > kLonger * extent.x() ? 1 : 0;
  divide(piece, middle, longer);
  if (piece.size() < kFew) return middle;
  const double size = static_cast<double>(piece.size()), most = elements_per_leaf_ * leaves;
  // Squares of two triangles, n / 2 in a square, have sqrt(n / 2) sides along the middle.
  const double of_squares = per_side_ * std::sqrt(size / 2 * extent[1 - longer] / extent[longer]);
  if (shared(piece, middle) <= kOfSquares * of_squares) return middle;
  const auto least_half =
      std::min(middle, static_cast<std::size_t>(std::max({kLeastHalf * size, most / 4, size - most})));
  Cut best = shortest(piece, least_half, longer);
  const Cut other = shortest(piece, least_half, 1 - longer);
  if (other.ratio < best.ratio) best = other;
  divide(piece, best.first_half, best.along);
  return best.first_half;
}

/// How many unknowns the halves share.
int ShortCut::shared(std::span<const Centre> piece, std::size_t first_half) {
  const int first = ++seen_, counted = ++seen_;
  for (const Centre& centre : piece.first(first_half))
    for (const int unknown : sum_.unknowns_of(centre.element))
      if (unknown >= 0) seen_as_[unknown] = first;
  int count = 0;
  for (const Centre& centre : piece.subspan(first_half))
    for (const int unknown : sum_.unknowns_of(centre.element))
      if (unknown >= 0 && seen_as_[unknown] == first) {
        ++count;
        seen_as_[unknown] = counted;
      }
  return count;
}

/// Of all cuts across an axis.
ShortCut::Cut ShortCut::shortest(std::span<Centre> piece, std::size_t least, int along) {
  const std::size_t size = piece.size(), middle = size / 2, most = size - least;
  divide(piece, least, along);
  divide(piece.subspan(least), most - least, along);
  std::sort(piece.begin() + static_cast<std::ptrdiff_t>(least),
            piece.begin() + static_cast<std::ptrdiff_t>(most), before(along));
  // The places between which cuts may go; all elements before and after them have one each.
  const auto place = [&](std::size_t i) {
    return static_cast<int>(std::clamp(i + 1, least, most + 1) - least);
  };
  const auto for_each_unknown = [&](const auto& visit) {
    for (std::size_t i = 0; i < size; ++i)
      for (const int unknown : sum_.unknowns_of(piece[i].element))
        if (unknown >= 0) visit(unknown, place(i));
  };
  const int found = ++seen_, counted = ++seen_;
  for_each_unknown([&](int unknown, int at) {
    if (seen_as_[unknown] != found) {
      seen_as_[unknown] = found;
      first_[unknown] = at;
    }
    last_[unknown] = at;
  });
  // By how many more unknowns a cut after a place shares than the one before it.
  std::vector<int> more(most - least + 2, 0);
  for_each_unknown([&](int unknown, int) {
    if (seen_as_[unknown] == counted) return;
    seen_as_[unknown] = counted;
    ++more[first_[unknown]];
    --more[last_[unknown]];
  });
  Cut best{along, middle, std::numeric_limits<double>::infinity()};
  int share = 0;
  for (std::size_t cut = least; cut <= most; ++cut) {
    share += more[cut - least];
    const double ratio = share / (static_cast<double>(cut) * static_cast<double>(size - cut));
    if (ratio < best.ratio) best = {along, cut, ratio};
  }
  return best;
}

}  // namespace signorini
