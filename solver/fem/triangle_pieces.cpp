#include "fem/triangle_pieces.hpp"

#include <algorithm>
#include <cmath>

#include "formula/enclosure.hpp"

namespace signorini {
namespace {

using Corners = std::array<Point, 3>;

const Corners kReference{Point(0, 0), Point(1, 0), Point(0, 1)};

double area(const Point& a, const Point& b, const Point& c) {
  return std::abs((b - a).x() * (c - a).y() - (b - a).y() * (c - a).x());
}

double area(const std::vector<Point>& polygon) {
  double sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) sum += area(polygon[0], polygon[i - 1], polygon[i]);
  return sum;
}

class Cutter {
 public:
  Cutter(std::span<const Field* const> fields, const Corners& corners, const Acceptance& accept,
         CellBudget& budget, const std::function<void(const TrianglePiece&)>& visit, const Settled& settled)
      : fields_(fields), corners_(corners), accept_(accept), budget_(budget), visit_(visit), settled_(settled) {}

  void run() { cut(kReference, 0); }

 private:
  /// Deeper than this a cell is too small to matter or the formula has a pole.
  static constexpr int kDeepest = 60;

  Point physical(const Point& reference) const {
    return corners_[0] + reference.x() * (corners_[1] - corners_[0]) + reference.y() * (corners_[2] - corners_[0]);
  }

  struct Values {
    std::vector<TaylorModel> models;
    std::optional<TaylorModel> undecided;
  };

  Values evaluate(const Corners& cell) const {
    const Point a = physical(cell[0]), b = physical(cell[1]), c = physical(cell[2]);
    Enclosure<TaylorModel> enclosure{TaylorModel::linear({a.x(), b.x(), c.x()}),
                                     TaylorModel::linear({a.y(), b.y(), c.y()}), TaylorModel(0.), TaylorModel(0.)};
    Values values;
    for (const Field* field : fields_)
      values.models.push_back(field->formula() ? field->formula()->evaluate(enclosure)
                                               : TaylorModel((*field)(Point::Zero())));
    values.undecided = enclosure.undecided;
    return values;
  }

  void visit(const Corners& cell, Values&& values) {
    visit_({cell, area(cell[0], cell[1], cell[2]), std::move(values.models)});
  }

  void cut(const Corners& cell, int depth) {
    budget_.look_around();
    const double share = area(cell[0], cell[1], cell[2]);
    if (share == 0 || (settled_ && settled_(cell, share))) return;
    Values values = evaluate(cell);
    if (accept_(values.models, share, share) || depth == kDeepest || budget_.cells <= 0) return visit(cell, std::move(values));
    --budget_.cells;
    if (values.undecided && cut_along(cell, values, depth)) return;
    // The longest side.
    int e = 0;
    double longest = -1;
    for (int k = 0; k < 3; ++k) {
      const double length = (physical(cell[(k + 1) % 3]) - physical(cell[(k + 2) % 3])).squaredNorm();
      if (length > longest) {
        longest = length;
        e = k;
      }
    }
    const Point &top = cell[e], &a = cell[(e + 1) % 3], &b = cell[(e + 2) % 3], middle = (a + b) / 2;
    cut({top, a, middle}, depth + 1);
    cut({top, middle, b}, depth + 1);
  }

  /// Both sides of the line where the linear part of the argument is 0, and between them the strip where its sign
  /// is not known. Returns false where that would be too wide.
  bool cut_along(const Corners& cell, const Values& values, int depth) {
    const TaylorModel& argument = *values.undecided;
    const std::array<double, TaylorModel::kSize>& c = argument.coefficients();
    double unknown = argument.remainder();
    for (int k = 2; k <= TaylorModel::kDegree; ++k) unknown += argument.size_of_degree(k);
    if (!std::isfinite(unknown) || (c[1] == 0 && c[2] == 0)) return false;
    // In the coordinates of the triangle.
    Eigen::Matrix2d jacobian;
    jacobian << cell[1] - cell[0], cell[2] - cell[0];
    const double determinant = jacobian(0, 0) * jacobian(1, 1) - jacobian(0, 1) * jacobian(1, 0);
    const auto linear = [&](const Point& x) {
      const Vector way = x - cell[0];
      const double u = (jacobian(1, 1) * way.x() - jacobian(0, 1) * way.y()) / determinant,
                   v = (jacobian(0, 0) * way.y() - jacobian(1, 0) * way.x()) / determinant;
      return c[0] + c[1] * (u - 1. / 3) + c[2] * (v - 1. / 3);
    };
    const std::vector<Point> whole(cell.begin(), cell.end());
    const auto above = [&](const Point& x) { return linear(x) - unknown; };
    const auto below = [&](const Point& x) { return -linear(x) - unknown; };
    std::vector<Point> strip = clip(clip(whole, [&](const Point& x) { return -above(x); }),
                                    [&](const Point& x) { return -below(x); });
    const double share = area(cell[0], cell[1], cell[2]);
    if (unknown > 0 && !accept_(values.models, area(strip), share)) return false;
    for (const auto& part : {clip(whole, above), clip(whole, below)})
      for (std::size_t i = 2; i < part.size(); ++i) cut({part[0], part[i - 1], part[i]}, depth + 1);
    if (unknown == 0) return true;
    for (std::size_t i = 2; i < strip.size(); ++i) {
      const Corners own{strip[0], strip[i - 1], strip[i]};
      if (area(own[0], own[1], own[2]) > 0) visit(own, evaluate(own));
    }
    return true;
  }

  std::span<const Field* const> fields_;
  const Corners& corners_;
  const Acceptance& accept_;
  CellBudget& budget_;
  const std::function<void(const TrianglePiece&)>& visit_;
  const Settled& settled_;
};

}  // namespace

std::vector<Point> clip(const std::vector<Point>& polygon, const std::function<double(const Point&)>& function) {
  std::vector<Point> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = function(a), at_b = function(b);
    if (at_a >= 0) inside.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0)) inside.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return inside;
}

Series series_on_triangle(const Formula& formula, const Corners& corners, int order, bool& undecided) {
  const auto& [a, b, c] = corners;
  const Point centroid = (a + b + c) / 3;
  const auto all = [&, &a = a, &b = b, &c = c](int i) {
    const Interval values(std::min({a[i], b[i], c[i]}), std::max({a[i], b[i], c[i]}));
    return Series::line(order, values, values - centroid[i]);
  };
  Enclosure<Series> enclosure{all(0), all(1), Series(order), Series(order)};
  Series series = formula.evaluate(enclosure);
  undecided = enclosure.undecided.has_value();
  return series;
}

Acceptance mean_remainder_below(double tolerance) {
  return [tolerance](const std::vector<TaylorModel>& models, double share, double of_cell) {
    double remainder = 0;
    for (const TaylorModel& own : models) remainder += own.remainder();
    return remainder * share <= tolerance * std::sqrt(of_cell);
  };
}

void for_each_piece(std::span<const Field* const> fields, const Corners& corners, const Acceptance& accept,
                    CellBudget& budget, const std::function<void(const TrianglePiece&)>& visit,
                    const Settled& settled) {
  Cutter(fields, corners, accept, budget, visit, settled).run();
}

}  // namespace signorini
