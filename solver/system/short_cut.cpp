#include "system/short_cut.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace signorini {
namespace {

/// So many times as long as one between squares may be a cut that is as good as any. On an even number of
/// squares it has once their length.
constexpr double kOfSquares = 1.25;

/// Extents that differ by less differ by rounding: pieces that are alike are to be cut alike.
constexpr double kLonger = 1 + 1e-9;

/// Gaps between centres that differ by less of the extent differ by rounding, or by the tilt.
constexpr double kWider = 1e-6;

/// Of cuts that are so nearly as good as the best, that of the widest gap is taken.
constexpr double kNearlyLeast = 1.02;

/// The least part of the elements that a half has.
constexpr double kLeastHalf = 0.3;

Eigen::AlignedBox2d box_of(std::span<const Centre> piece) {
  Eigen::AlignedBox2d box;
  for (const Centre& centre : piece) box.extend(Point(centre.at[0], centre.at[1]));
  return box;
}

auto before(int along) {
  return [along](const Centre& a, const Centre& b) { return a.at[along] < b.at[along]; };
}

auto at(std::span<Centre> piece, std::size_t place) {
  return piece.begin() + static_cast<std::ptrdiff_t>(place);
}

void divide(std::span<Centre> piece, std::size_t first_half, int along) {
  std::nth_element(piece.begin(), at(piece, first_half), piece.end(), before(along));
}

/// Between the centres on both sides of a cut, where they are sorted.
double gap_before(std::span<const Centre> piece, std::size_t cut, int along) {
  return piece[cut].at[along] - piece[cut - 1].at[along];
}

}  // namespace

std::vector<Centre> tilted(const std::vector<Point>& centres) {
  Eigen::AlignedBox2d box;
  for (const Point& centre : centres) box.extend(centre);
  const Eigen::Vector2d sizes = box.sizes();
  // Across columns of squares x varies by much more, even if there are a million.
  constexpr double tilt = 1e-8;
  const double of_x = sizes.y() > 0 ? tilt * sizes.x() / sizes.y() : 0,
               of_y = sizes.x() > 0 ? tilt * sizes.y() / sizes.x() : 0;
  std::vector<Centre> tilted;
  tilted.reserve(centres.size());
  for (int e = 0; e < static_cast<int>(centres.size()); ++e) {
    const Point own = centres[e] - box.min();
    tilted.push_back({{own.x() + of_x * own.y(), own.y() + of_y * own.x()}, e});
  }
  return tilted;
}

ShortCut::ShortCut(const SharedNumbers& numbers, int elements, int leaves)
    : numbers_(numbers),
      elements_per_leaf_(static_cast<double>(elements) / leaves),
      per_side_(static_cast<double>(std::ranges::count_if(numbers.all, [](int i) { return i >= 0; })) /
                (3. * elements)),
      seen_as_(numbers.size, 0),
      first_(numbers.size),
      last_(numbers.size) {}

std::size_t ShortCut::operator()(std::span<Centre> piece, int leaves) {
  const Eigen::AlignedBox2d box = box_of(piece);
  const Eigen::Vector2d extent = box.sizes();
  const int longer = extent.y() > kLonger * extent.x() ? 1 : 0;
  const std::size_t middle = divide_between_columns(piece, longer, box);
  if (piece.size() < kFew) return middle;
  const double size = static_cast<double>(piece.size()), most = elements_per_leaf_ * leaves;
  // Squares of two triangles, n / 2 in a square, have sqrt(n / 2) sides along the middle.
  const double of_squares = per_side_ * std::sqrt(size / 2 * extent[1 - longer] / extent[longer]);
  if (shared(piece, middle) <= kOfSquares * of_squares) return middle;
  const auto least_half = std::min(
      piece.size() / 2, static_cast<std::size_t>(std::max({kLeastHalf * size, most / 4, size - most})));
  Cut best = shortest(piece, least_half, longer);
  const Cut other = shortest(piece, least_half, 1 - longer);
  if (other.ratio < best.ratio) best = other;
  divide(piece, best.first_half, best.along);
  return best.first_half;
}

/// Divides at the widest gap that is no farther from the median than a column of squares has elements, of
/// several at the nearest. Of squares that is between two columns, whatever their diagonals: a cut through a
/// column would be longer, and no piece with a ragged side is like another. Returns the size of the first
/// half.
std::size_t ShortCut::divide_between_columns(std::span<Centre> piece, int along,
                                             const Eigen::AlignedBox2d& box) {
  const std::size_t size = piece.size(), median = size / 2;
  const auto column = static_cast<std::size_t>(std::sqrt(2. * static_cast<double>(size)));
  const std::size_t reach = std::min(size / 6, column);
  if (reach == 0) {
    divide(piece, median, along);
    return median;
  }
  const double extent = box.sizes()[along];
  const std::size_t first = median - reach;
  find_between(piece, first, median + reach, along, {box.min()[along], extent});
  const auto gap_before = [&](std::size_t cut) { return between_[cut - first] - between_[cut - 1 - first]; };
  std::size_t best = median;
  for (std::size_t away = 1; away < reach; ++away)
    for (const std::size_t cut : {median - away, median + away})
      if (gap_before(cut) > gap_before(best) + kWider * extent) best = cut;
  if (gap_before(best) > 0)
    divide_before(piece, between_[best - first], along);
  else
    divide(piece, best, along);
  return best;
}

/// The coordinates of the elements from the first to the last of those places, in ascending order. Of many
/// they are looked for in bins: a few streams through memory, without a guess at each comparison.
void ShortCut::find_between(std::span<const Centre> piece, std::size_t first, std::size_t last, int along,
                            const Range& range) {
  constexpr std::size_t few = 512, bins = 1024;
  const double per_length = bins / range.extent;
  between_.clear();
  std::size_t below = 0;
  if (piece.size() < few || !std::isfinite(per_length)) {
    for (const Centre& centre : piece) between_.push_back(centre.at[along]);
  } else {
    const auto bin = [&](const Centre& centre) {
      return std::min(bins - 1, static_cast<std::size_t>((centre.at[along] - range.low) * per_length));
    };
    std::array<std::size_t, bins + 1> ends{};  // behind the bin before
    for (const Centre& centre : piece) ++ends[bin(centre) + 1];
    std::partial_sum(ends.begin(), ends.end(), ends.begin());
    const auto of_place = [&](std::size_t place) {
      return static_cast<std::size_t>(std::ranges::upper_bound(ends, place) - ends.begin()) - 1;
    };
    const std::size_t low = of_place(first), high = of_place(last);
    below = ends[low];
    for (const Centre& centre : piece)
      if (const std::size_t own = bin(centre); low <= own && own <= high)
        between_.push_back(centre.at[along]);
  }
  const auto place = [&](std::size_t i) { return between_.begin() + static_cast<std::ptrdiff_t>(i - below); };
  std::nth_element(between_.begin(), place(first), between_.end());
  std::nth_element(place(first), place(last), between_.end());
  std::sort(place(first), place(last));
  between_.erase(between_.begin(), place(first));
}

/// Both halves in the order that they had, so that those that are alike stay alike.
void ShortCut::divide_before(std::span<Centre> piece, double coordinate, int along) {
  second_half_.clear();
  auto next = piece.begin();
  for (const Centre& centre : piece)
    if (centre.at[along] < coordinate)
      *next++ = centre;
    else
      second_half_.push_back(centre);
  std::ranges::copy(second_half_, next);
}

/// How many numbers the halves share.
int ShortCut::shared(std::span<const Centre> piece, std::size_t first_half) {
  const int first = ++seen_, counted = ++seen_;
  for (const Centre& centre : piece.first(first_half))
    for (const int number : numbers_.of(centre.element))
      if (number >= 0) seen_as_[number] = first;
  int count = 0;
  for (const Centre& centre : piece.subspan(first_half))
    for (const int number : numbers_.of(centre.element))
      if (number >= 0 && seen_as_[number] == first) {
        ++count;
        seen_as_[number] = counted;
      }
  return count;
}

/// Of all cuts across an axis.
ShortCut::Cut ShortCut::shortest(std::span<Centre> piece, std::size_t least, int along) {
  const std::size_t size = piece.size(), most = size - least;
  const double rounding = kWider * box_of(piece).sizes()[along];
  divide(piece, least, along);
  divide(piece.subspan(least), most - least, along);
  std::sort(at(piece, least), at(piece, most), before(along));
  // The places between which cuts may go; all elements before and after them have one each.
  const auto place = [&](std::size_t i) {
    return static_cast<int>(std::clamp(i + 1, least, most + 1) - least);
  };
  const auto for_each_number = [&](const auto& visit) {
    for (std::size_t i = 0; i < size; ++i)
      for (const int number : numbers_.of(piece[i].element))
        if (number >= 0) visit(number, place(i));
  };
  const int found = ++seen_, counted = ++seen_;
  for_each_number([&](int number, int at) {
    if (seen_as_[number] != found) {
      seen_as_[number] = found;
      first_[number] = at;
    }
    last_[number] = at;
  });
  // By how many more numbers a cut after a place shares than the one before it.
  std::vector<int> more(most - least + 2, 0);
  for_each_number([&](int number, int) {
    if (seen_as_[number] == counted) return;
    seen_as_[number] = counted;
    ++more[first_[number]];
    --more[last_[number]];
  });
  std::vector<double> ratios;
  int share = 0;
  for (std::size_t cut = least; cut <= most; ++cut) {
    share += more[cut - least];
    ratios.push_back(share / (static_cast<double>(cut) * static_cast<double>(size - cut)));
  }
  const double enough = kNearlyLeast * *std::ranges::min_element(ratios);
  Cut best{along, size / 2, std::numeric_limits<double>::infinity()};
  double widest = -1;
  for (std::size_t cut = least; cut <= most; ++cut) {
    const double ratio = ratios[cut - least];
    if (ratio > enough) continue;
    const double gap = least < cut && cut < most ? gap_before(piece, cut, along) : 0;
    if (gap < widest - rounding || (gap <= widest + rounding && ratio >= best.ratio)) continue;
    widest = gap;
    best = {along, cut, ratio};
  }
  return best;
}

}  // namespace signorini
