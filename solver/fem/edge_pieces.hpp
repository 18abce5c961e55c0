#pragma once

#include <array>
#include <functional>
#include <vector>

#include "fem/triangle_pieces.hpp"
#include "formula/series.hpp"
#include "mesh/mesh.hpp"
#include "problem/field.hpp"

namespace signorini {

/// An edge of the boundary from s = 0 to s = 1, with its outward normal. What is asked of it is asked of the
/// arc if it is the chord of one.
struct EdgeLine {
  EdgeLine(const Mesh& of, int number) : mesh(of), edge(number), normal(of.outward_normal(number)) {}

  Point at(double s) const { return mesh.on_boundary(edge, s).x; }
  double value(const Field& field, double s) const {
    const auto [x, outward] = mesh.on_boundary(edge, s);
    return field(x, outward);
  }

  const Mesh& mesh;
  int edge;
  Vector normal;  ///< of the edge itself
};

/// A part of an edge on which a field is a polynomial of degree 4 in s − middle, but for a remainder.
struct EdgePiece {
  static constexpr int kDegree = 4;

  double begin, end;
  std::array<double, kDegree + 1> coefficients{};
  double remainder = 0;

  double length() const { return end - begin; }
  double middle() const { return (begin + end) / 2; }
  double operator()(double s) const;
};

/// Cuts the edge into halves until the mean of the remainders is about `tolerance`, a value of the field, or
/// the budget is used up. Of a function its values in five points are taken, as if it were a polynomial.
std::vector<EdgePiece> pieces_on_edge(const Field& field, const EdgeLine& edge, double tolerance,
                                      CellBudget& budget);

/// The Taylor coefficients of the field in s, for all s from begin to end. Not for functions.
Series series_on(const Field& field, const EdgeLine& edge, const Interval& s, int order);

/// The value of the field in an end of the edge, s = 0 or 1; where it jumps there, or has no value, those
/// that it has beside the end on this edge. A difference of less than `rounding` is no jump.
Interval values_at_end(const Field& field, const EdgeLine& edge, double s, double rounding);

/// All that can be told of the field: it is a constant, a formula, or says that it is quadratic.
inline bool is_known_on_edges(const Field& field) {
  return field.is_constant() || field.formula() || field.is_quadratic_on_edges();
}

}  // namespace signorini
