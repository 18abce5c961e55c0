#include "certify/pressure/contact_terms.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/rounding.hpp"

namespace signorini {
namespace {

/// What g − p may be in the mean, relative to v.
constexpr double kMeanTolerance = 1e-10;

constexpr ContactTerms::Work unknown{0, std::numeric_limits<double>::infinity()};

}  // namespace

ContactTerms::ContactTerms(const Discretization& discrete, const AdmissibleDisplacement& v, int i,
                           CellBudget& budget)
    : discrete_(discrete),
      edge_(i),
      contact_(discrete.clearance.edges[i]),
      length_(discrete.mesh.length(contact_.edge)) {
  const double size = std::abs(v.along_contact(contact_, 0)) + std::abs(v.along_contact(contact_, 0.5)) +
                      std::abs(v.along_contact(contact_, 1));
  pieces_ = pieces_on_edge(gap_on(discrete, contact_), EdgeLine(discrete.mesh, contact_.edge),
                           kMeanTolerance * size, budget);
}

ContactTerms::Work ContactTerms::work(const ContactPressure& pressure,
                                      const AdmissibleDisplacement& v) const {
  const EdgePressure own = pressure.on(discrete_, edge_);
  Work sum;
  for (const EdgePiece& piece : pieces_) {
    const double begin = std::max(piece.begin, own.begin), length = std::min(piece.end, own.end) - begin;
    for (int q = 0; length > 0 && q < EdgeRule::size; ++q) {
      const double s = begin + length * edge_rule().points[q];
      const double force = length_ * length * edge_rule().weights[q] * own(s);
      if (force == 0) continue;
      if (!std::isfinite(piece.remainder)) return unknown;
      sum.value += force * (piece(s) - v.along_contact(contact_, s));
      sum.radius += std::abs(force) * piece.remainder;
    }
  }
  return sum;
}

/// The rule is exact for a linear weight; what w has beyond that counts as unknown.
ContactTerms::Work ContactTerms::opening(const Field& weight, const AdmissibleDisplacement& v,
                                         CellBudget& budget) const {
  const EdgeLine line(discrete_.mesh, contact_.edge);
  const double size = std::abs(line.value(weight, 0)) + std::abs(line.value(weight, 0.5)) +
                      std::abs(line.value(weight, 1)),
               largest_v = v.largest_on(discrete_.mesh.edge_triangles[contact_.edge][0]);
  const auto from = [](const EdgePiece& piece, std::size_t first) {
    double sum = piece.remainder;
    for (std::size_t k = first; k < piece.coefficients.size(); ++k)
      sum += std::abs(piece.coefficients[k]) * std::pow(piece.length() / 2, k);
    return sum;
  };
  Work sum;
  for (const EdgePiece& w : pieces_on_edge(weight, line, kMeanTolerance * size, budget))
    for (const EdgePiece& g : pieces_) {
      const double begin = std::max(w.begin, g.begin), length = std::min(w.end, g.end) - begin;
      if (!(length > 0) || from(w, 0) == 0) continue;
      if (!std::isfinite(from(w, 0) + g.remainder)) return unknown;
      for (int q = 0; q < EdgeRule::size; ++q) {
        const double s = begin + length * edge_rule().points[q];
        const double linear = w.coefficients[0] + w.coefficients[1] * (s - w.middle()), gap = g(s),
                     v_n = v.along_contact(contact_, s),
                     own = length_ * length * edge_rule().weights[q] * linear;
        sum.value += own * (gap - v_n);
        sum.radius += kRoundingOfSums * std::abs(own) * (std::abs(gap) + std::abs(v_n));
      }
      sum.radius += length_ * length * (from(w, 0) * g.remainder + from(w, 2) * (from(g, 0) + largest_v));
    }
  return sum;
}

double ContactTerms::operator()(const ContactPressure& pressure, const AdmissibleDisplacement& v) const {
  const Work own = work(pressure, v);
  return 2 * std::max(0., own.value + own.radius);
}

}  // namespace signorini
