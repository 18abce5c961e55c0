#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace signorini {

/// The number of one of the last few `known` matrices that is equal to the given one but for rounding; or
/// else the one that keep() answers, which is known from then on. `matrix_of(number)` is a matrix that was
/// kept.
template <typename Matrix, typename MatrixOf, typename Keep>
int number_of_alike(const Matrix& given, std::vector<int>& known, const MatrixOf& matrix_of,
                    const Keep& keep) {
  constexpr std::size_t few = 8;
  constexpr double rounding = 1e-12;
  const double size = given.template lpNorm<Eigen::Infinity>();
  const auto alike = std::ranges::find_if(known, [&](int own) {
    return (given - matrix_of(own)).template lpNorm<Eigen::Infinity>() <= rounding * size;
  });
  if (alike != known.end()) return *alike;
  if (known.size() == few) known.erase(known.begin());
  return known.emplace_back(keep());
}

}  // namespace signorini
