#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "certify/displacement/admissible_displacement.hpp"

namespace signorini {

/// What an admissible pair counts in a sum over several pairs on one mesh: the first one once.
struct PairTerm {
  double factor;
  const Discretization& discrete;  ///< which the pair belongs to
  const Eigen::MatrixXd& stress;   ///< σ_h
  const AdmissibleDisplacement& v;
};

template <int D, typename Term>
Quadratic<D> displacement_on(const std::vector<Term>& terms, int t) {
  Quadratic<D> sum = Quadratic<D>::Zero();
  for (const PairTerm& term : terms) sum += term.factor * term.v.on<D>(t);
  return sum;
}

template <typename Term>
ProjectedLoad load_on(const std::vector<Term>& terms, int t) {
  ProjectedLoad sum = terms[0].discrete.body[t];
  for (std::size_t i = 1; i < terms.size(); ++i) sum = sum.plus(terms[i].factor, terms[i].discrete.body[t]);
  return sum;
}

template <typename Term>
bool is_lifted(const std::vector<Term>& terms, int t) {
  return std::ranges::any_of(terms, [t](const PairTerm& term) { return term.v.is_lifted(t); });
}

/// As AdmissibleDisplacement::add_lifts().
template <int D, typename Term>
void add_lifts(const std::vector<Term>& terms, int t, const Point& reference, const Eigen::Matrix2d& inverse,
               Eigen::Matrix<double, D, 1>& value, Tensor<D>& slope) {
  for (const PairTerm& term : terms) {
    Eigen::Matrix<double, D, 1> own = Eigen::Matrix<double, D, 1>::Zero();
    Tensor<D> own_slope = Tensor<D>::Zero();
    term.v.add_lifts<D>(t, reference, inverse, own, own_slope);
    value += term.factor * own;
    slope += term.factor * own_slope;
  }
}

template <typename Term>
AdmissibleDisplacement::LiftRest rest_of_lifts(const std::vector<Term>& terms, int t) {
  AdmissibleDisplacement::LiftRest sum;
  for (const PairTerm& term : terms) {
    const AdmissibleDisplacement::LiftRest own = term.v.rest_of_lifts(t);
    sum.value += std::abs(term.factor) * own.value;
    sum.slope += std::abs(term.factor) * own.slope;
  }
  return sum;
}

}  // namespace signorini
