#include "system/element_sum.hpp"

#include <algorithm>

namespace signorini {

int ElementSum::keep(const double* values) {
  const std::size_t count = static_cast<std::size_t>(per_element) * per_element;
  matrices.insert(matrices.end(), values, values + count);
  return static_cast<int>(matrices.size() / count) - 1;
}

int ElementSum::keep(const double* values, std::vector<int>& known) {
  constexpr std::size_t few = 8;
  const std::size_t count = static_cast<std::size_t>(per_element) * per_element;
  constexpr double rounding = 1e-12;
  const Eigen::Map<const Eigen::VectorXd> given(values, static_cast<Eigen::Index>(count));
  const auto equal = std::ranges::find_if(known, [&](int own) {
    const Eigen::Map<const Eigen::VectorXd> other(matrices.data() + own * count, given.size());
    return (given - other).lpNorm<Eigen::Infinity>() <= rounding * given.lpNorm<Eigen::Infinity>();
  });
  if (equal != known.end()) return *equal;
  if (known.size() == few) known.erase(known.begin());
  return known.emplace_back(keep(values));
}

std::vector<double> ElementSum::diagonal() const {
  std::vector<double> all(size);
  for (int element = 0; element < elements(); ++element) {
    const auto rows = unknowns_of(element);
    const double* values = matrix(element);
    for (int j = 0; j < per_element; ++j)
      for (int i = 0; i < per_element; ++i)
        if (rows[j] >= 0 && rows[i] == rows[j]) all[rows[j]] += values[j * per_element + i];
  }
  return all;
}

}  // namespace signorini
