#include "system/element_sum.hpp"

#include "system/alike_matrices.hpp"

namespace signorini {

int ElementSum::keep(const double* values) {
  if (blocks.empty() || blocks.back().size() == kPerBlock * numbers())
    blocks.emplace_back().reserve(kPerBlock * numbers());
  std::vector<double>& last = blocks.back();
  last.insert(last.end(), values, values + numbers());
  return static_cast<int>((blocks.size() - 1) * kPerBlock + last.size() / numbers()) - 1;
}

int ElementSum::keep(const double* values, std::vector<int>& known) {
  const auto as_matrix = [this](const double* first) {
    return Eigen::Map<const Eigen::MatrixXd>(first, per_element, per_element);
  };
  return number_of_alike(
      as_matrix(values), known, [&](int own) { return as_matrix(kept(own)); }, [&] { return keep(values); });
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
