#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace signorini {

/// The number of one of the last few `known` matrices that is equal to the given one but for rounding; or
/// else the one that keep() answers, which is known from then on. `matrix_of(number)` is a matrix that was
/// kept.
///
/// They are symmetric and positive semidefinite, so that an entry is no larger than the root of those on the
/// diagonal beside it and above it: rounding is that of this root, for unknowns may have units of their own,
/// turns beside displacements.
template <typename Matrix, typename MatrixOf, typename Keep>
int number_of_alike(const Matrix& given, std::vector<int>& known, const MatrixOf& matrix_of,
                    const Keep& keep) {
  constexpr std::size_t few = 8;
  constexpr double rounding = 1e-12;
  const Eigen::ArrayXd sizes = given.diagonal().array().abs().sqrt();
  const auto alike = std::ranges::find_if(known, [&](int own) {
    const auto off = (given - matrix_of(own)).array().abs();
    return (off <= rounding * (sizes.matrix() * sizes.matrix().transpose()).array()).all();
  });
  if (alike != known.end()) return *alike;
  if (known.size() == few) known.erase(known.begin());
  return known.emplace_back(keep());
}

}  // namespace signorini
