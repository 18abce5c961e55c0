#include "system/element_sum.hpp"

#include <algorithm>

namespace signorini {

int ElementSum::keep(const double* values) {
  if (blocks.empty() || blocks.back().size() == kPerBlock * numbers())
    blocks.emplace_back().reserve(kPerBlock * numbers());
  std::vector<double>& last = blocks.back();
  last.insert(last.end(), values, values + numbers());
  return static_cast<int>((blocks.size() - 1) * kPerBlock + last.size() / numbers()) - 1;
}

int ElementSum::keep(const double* values, std::vector<int>& known) {
  constexpr std::size_t few = 8;
  constexpr double rounding = 1e-12;
  const Eigen::Map<const Eigen::VectorXd> given(values, static_cast<Eigen::Index>(numbers()));
  const auto equal = std::ranges::find_if(known, [&](int own) {
    const Eigen::Map<const Eigen::VectorXd> other(kept(own), given.size());
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
