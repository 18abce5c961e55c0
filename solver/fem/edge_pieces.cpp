#include "fem/edge_pieces.hpp"

#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include <Eigen/LU>

#include "fem/quadrature.hpp"
#include "formula/enclosure.hpp"

namespace signorini {
namespace {

constexpr int kDegree = EdgePiece::kDegree;

/// x, y and the normal along the edge, or along the arc X = c + R (p − c) / |p − c| over the points p of its
/// chord.
Enclosure<Series> along(const EdgeLine& edge, const Interval& s, int order) {
  const Mesh& mesh = edge.mesh;
  const Point &from = mesh.points[mesh.edges[edge.edge][0]], &to = mesh.points[mesh.edges[edge.edge][1]];
  // Both ends of the edge as they are: what is decided there must not depend on rounding.
  const auto on_chord = [&](int i) {
    const double way = to[i] - from[i], first = s.lower() == 0 ? from[i] : from[i] + s.lower() * way,
                 last = s.upper() == 1 ? to[i] : from[i] + s.upper() * way;
    return Series::line(order, Interval(std::min(first, last), std::max(first, last)), way);
  };
  const int circle = mesh.circle_of(edge.edge);
  if (circle < 0)
    return {on_chord(0), on_chord(1), Series(order, edge.normal.x()), Series(order, edge.normal.y())};
  const Point& centre = mesh.circles[circle].centre;
  const double radius = mesh.circles[circle].radius;
  const auto constant = [&](double value) { return Series(order, value); };
  const auto from_centre = [&](int i) {
    return smooth(Operation::subtract, on_chord(i), constant(centre[i]));
  };
  const Series x = from_centre(0), y = from_centre(1), two = constant(2);
  const Series distance = smooth(Operation::sqrt, smooth(Operation::add, smooth(Operation::power, x, two),
                                                         smooth(Operation::power, y, two)));
  const double sign = (edge.at(0.5) - centre).dot(edge.normal) > 0 ? 1 : -1;
  const auto outward = [&](const Series& own) { return smooth(Operation::divide, own, distance); };
  const auto on_arc = [&](const Series& own, int i) {
    return smooth(Operation::add, constant(centre[i]),
                  smooth(Operation::multiply, constant(radius), outward(own)));
  };
  const auto normal = [&](const Series& own) {
    return smooth(Operation::multiply, constant(sign), outward(own));
  };
  return {on_arc(x, 0), on_arc(y, 1), normal(x), normal(y)};
}

Series enclose(const Formula& formula, const EdgeLine& edge, const Interval& s, int order) {
  Enclosure<Series> enclosure = along(edge, s, order);
  enclosure.strict = order > 0;  // of the values beside an end alone, rounding tells on which side it is
  return formula.evaluate(enclosure);
}

/// The polynomial through the values in the points of the rule, which are no points of another edge.
EdgePiece interpolated(const Field& field, const EdgeLine& edge) {
  Eigen::Matrix<double, kDegree + 1, kDegree + 1> powers;
  Eigen::Matrix<double, kDegree + 1, 1> values;
  for (int i = 0; i <= kDegree; ++i) {
    const double s = edge_rule().points[i];
    values[i] = edge.value(field, s);
    for (int k = 0; k <= kDegree; ++k) powers(i, k) = std::pow(s - 0.5, k);
  }
  const Eigen::Matrix<double, kDegree + 1, 1> c = powers.partialPivLu().solve(values);
  static_assert(EdgeRule::size == kDegree + 1);
  EdgePiece piece{0, 1};
  for (int k = 0; k <= kDegree; ++k)
    piece.coefficients[k] = field.is_quadratic_on_edges() && k > 2 ? 0 : c[k];
  return piece;
}

EdgePiece piece_of(const Formula& formula, const EdgeLine& edge, double begin, double end) {
  EdgePiece piece{begin, end};
  const Series all = enclose(formula, edge, Interval(begin, end), kDegree + 1);
  const double half = piece.length() / 2, rest = largest(all[kDegree + 1]) * std::pow(half, kDegree + 1);
  const Interval& values = all[0];
  const double radius =
      is_known(values) ? (values.upper() - values.lower()) / 2 : std::numeric_limits<double>::infinity();
  const double middle = piece.middle();
  const Series at_middle = enclose(formula, edge, Interval(middle, middle), kDegree);
  if (rest <= radius && is_known(at_middle[kDegree])) {
    for (int k = 0; k <= kDegree; ++k) piece.coefficients[k] = boost::numeric::median(at_middle[k]);
    piece.remainder = rest;
  } else {
    piece.coefficients[0] = is_known(values) ? boost::numeric::median(values) : 0;
    piece.remainder = radius;
  }
  return piece;
}

}  // namespace

double EdgePiece::operator()(double s) const {
  double value = 0;
  for (int k = kDegree; k >= 0; --k) value = value * (s - middle()) + coefficients[k];
  return value;
}

Series series_on(const Field& field, const EdgeLine& edge, const Interval& s, int order) {
  if (const Formula* formula = field.formula()) return enclose(*formula, edge, s, order);
  if (field.is_constant()) return Series(order, field(Point::Zero()));
  const EdgePiece piece = interpolated(field, edge);
  const Series line = Series::line(order, s - piece.middle(), 1);
  Series all(order, piece.coefficients[kDegree]);
  for (int k = kDegree; k-- > 0;)
    all =
        smooth(Operation::add, smooth(Operation::multiply, all, line), Series(order, piece.coefficients[k]));
  return all;
}

Interval values_at_end(const Field& field, const EdgeLine& edge, double s, double rounding) {
  const Formula* formula = field.formula();
  if (!formula) return edge.value(field, s);
  constexpr double hardly = 1e-9;
  const Interval beside =
      enclose(*formula, edge, s == 0 ? Interval(0, hardly) : Interval(1 - hardly, 1), 0)[0];
  const auto [x, normal] = edge.mesh.on_boundary(edge.edge, s);
  const double value = (*formula)(x.x(), x.y(), normal.x(), normal.y());
  if (!is_known(beside)) return std::isfinite(value) ? Interval(value) : kAnything;
  return beside.lower() - rounding <= value && value <= beside.upper() + rounding ? Interval(value) : beside;
}

std::vector<EdgePiece> pieces_on_edge(const Field& field, const EdgeLine& edge, double tolerance,
                                      CellBudget& budget) {
  if (!field.formula()) return {interpolated(field, edge)};
  const auto less = [](const EdgePiece& a, const EdgePiece& b) {
    return std::pair(a.remainder * a.length(), a.length()) < std::pair(b.remainder * b.length(), b.length());
  };
  std::priority_queue<EdgePiece, std::vector<EdgePiece>, decltype(less)> open(less);
  std::vector<EdgePiece> pieces;
  const auto look_at = [&](double begin, double end) {
    const EdgePiece piece = piece_of(*field.formula(), edge, begin, end);
    const bool is_good = piece.remainder * piece.length() <= tolerance * std::sqrt(piece.length());
    if (is_good || !(begin < piece.middle() && piece.middle() < end))
      pieces.push_back(piece);
    else
      open.push(piece);
  };
  for (look_at(0, 1); !open.empty() && budget.cells > 0; --budget.cells) {
    budget.look_around();
    const EdgePiece piece = open.top();
    open.pop();
    look_at(piece.begin, piece.middle());
    look_at(piece.middle(), piece.end);
  }
  for (; !open.empty(); open.pop()) pieces.push_back(open.top());
  return pieces;
}

}  // namespace signorini
