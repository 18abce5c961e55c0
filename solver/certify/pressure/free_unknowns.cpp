#include "certify/pressure/free_unknowns.hpp"

#include <algorithm>
#include <cmath>

namespace signorini {
namespace {

/// Below this part of a row's coefficients what elimination leaves is rounding.
constexpr double kTermRounding = 1e-12;

}  // namespace

void FreeUnknowns::take_away(const LinearForm& row) {
  Combination rest;
  double largest = 0;
  for (const auto& [unknown, factor] : row) {
    largest = std::max(largest, std::abs(factor));
    const auto known = known_.find(unknown);
    if (known == known_.end()) {
      rest[unknown] += factor;
      continue;
    }
    for (const auto& [other, share] : known->second) {
      rest[other] += factor * share;
      largest = std::max(largest, std::abs(factor * share));
    }
  }
  // What is left of terms that cancel would fill the combinations.
  std::erase_if(rest, [&](const auto& term) { return std::abs(term.second) <= kTermRounding * largest; });
  const auto pivot =
      std::ranges::max_element(rest, {}, [](const auto& term) { return std::abs(term.second); });
  if (pivot == rest.end()) return;
  const auto [unknown, factor] = *pivot;
  rest.erase(pivot);
  for (auto& term : rest) term.second /= -factor;
  if (const auto users = users_.extract(unknown))
    for (const int user : users.mapped()) {
      Combination& combination = known_.at(user);
      const auto used = combination.find(unknown);
      if (used == combination.end()) continue;
      const double times = used->second;
      combination.erase(used);
      add(times, rest, user, combination);
    }
  for (const auto& [other, share] : rest) users_[other].push_back(unknown);
  known_.emplace(unknown, std::move(rest));
}

void FreeUnknowns::add(double times, const Combination& some, int to, Combination& sum) {
  for (const auto& [unknown, factor] : some) {
    const auto [term, is_new] = sum.try_emplace(unknown, 0);
    if (is_new) users_[unknown].push_back(to);
    const double before = term->second, after = term->second += times * factor;
    if (std::abs(after) <= kTermRounding * std::abs(before)) sum.erase(term);
  }
}

Eigen::SparseMatrix<double> FreeUnknowns::basis(int unknowns) const {
  std::vector<int> column(unknowns);
  int columns = 0;
  for (int i = 0; i < unknowns; ++i) column[i] = known_.contains(i) ? -1 : columns++;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < unknowns; ++i)
    if (column[i] >= 0) entries.emplace_back(i, column[i], 1);
  for (const auto& [unknown, combination] : known_)
    for (const auto& [other, factor] : combination) entries.emplace_back(unknown, column[other], factor);
  Eigen::SparseMatrix<double> basis(unknowns, columns);
  basis.setFromTriplets(entries.begin(), entries.end());
  return basis;
}

}  // namespace signorini
