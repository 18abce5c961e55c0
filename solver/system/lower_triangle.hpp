#pragma once

#include <algorithm>
#include <cstddef>

namespace signorini {

/// Where the lower triangle of a dense symmetric matrix stands: strips of columns one behind the other, each
/// a rectangle of the rows from its diagonal on, column by column, as BLAS takes it. That is little more than
/// half of the square.
class LowerTriangle {
 public:
  /// Columns of a strip: wide enough for BLAS to be fast.
  static constexpr int kStrip = 128;

  explicit LowerTriangle(int rows) : rows_(rows) {}

  /// Numbers in all.
  std::size_t size() const { return begin(rows_ / kStrip * kStrip) + square(rows_ % kStrip); }

  /// The first number of the strip that begins with a column.
  std::size_t begin(int column) const {
    const auto columns = static_cast<std::size_t>(column);
    return columns * rows_ - columns * (columns - std::min<std::size_t>(columns, kStrip)) / 2;
  }
  int rows_of_strip(int column) const { return rows_ - column; }  ///< the distance between its columns, too
  int columns_of_strip(int column) const { return std::min(kStrip, rows_ - column); }

  /// A column among the values, to be indexed with rows from the diagonal on.
  template <typename Value>
  Value* column(Value* values, int j) const {
    const int strip = j / kStrip * kStrip;
    return values + begin(strip) + static_cast<std::ptrdiff_t>(j - strip) * rows_of_strip(strip) - strip;
  }

 private:
  static std::size_t square(int n) { return static_cast<std::size_t>(n) * n; }

  int rows_;
};

/// Numbers of a triangle with so many rows, whole or not, and no fewer.
constexpr double numbers_of_lower_triangle(double rows) {
  return rows * (std::min<double>(rows, LowerTriangle::kStrip) + rows) / 2;
}

}  // namespace signorini
