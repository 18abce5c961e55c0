#include "fem/triangle_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

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

/// The models on a triangle, and what is not decided on it.
struct Values {
  Models models;
  std::optional<TaylorModel> undecided;
};

using Assumptions = std::vector<Enclosure<TaylorModel>::Assumption>;

Values evaluate(std::span<const Field* const> fields, const Corners& corners,
                const Assumptions& assumptions) {
  const auto& [a, b, c] = corners;
  Enclosure<TaylorModel> enclosure{TaylorModel::linear({a.x(), b.x(), c.x()}),
                                   TaylorModel::linear({a.y(), b.y(), c.y()}), TaylorModel(0.),
                                   TaylorModel(0.), assumptions};
  Values values;
  for (const Field* field : fields)
    values.models.push_back(field->formula() ? field->formula()->evaluate(enclosure)
                                             : TaylorModel((*field)(Point::Zero())));
  values.undecided = enclosure.undecided;
  return values;
}

void add_branches(std::span<const Field* const> fields, const Corners& corners, Assumptions& assumptions,
                  std::vector<Models>& branches) {
  constexpr std::size_t most_assumptions = 3;
  Values values = evaluate(fields, corners, assumptions);
  if (!values.undecided || assumptions.size() == most_assumptions) {
    branches.push_back(std::move(values.models));
    return;
  }
  for (const bool is_positive : {true, false}) {
    assumptions.push_back({*values.undecided, is_positive});
    add_branches(fields, corners, assumptions, branches);
    assumptions.pop_back();
  }
}

/// The width of what is known; without a bound is worse than any.
struct Doubt {
  double unknown = 0, width = 0;

  Doubt& operator+=(const Doubt& other) {
    unknown += other.unknown;
    width += other.width;
    return *this;
  }
  auto operator<=>(const Doubt&) const = default;
};

Doubt doubt(const Interval& values, double scale, double share) {
  if (!is_known(values)) return {share, 0};
  return {0, share * (values.upper() - values.lower()) / scale};
}

/// What is most in doubt is cut first, so that a budget that is used up leaves the least.
class Cutter {
 public:
  Cutter(std::span<const Field* const> fields, const Corners& corners, const Acceptance& accept,
         CellBudget& budget, const std::function<void(const TrianglePiece&)>& visit, const Settled& settled)
      : fields_(fields),
        corners_(corners),
        accept_(accept),
        budget_(budget),
        visit_(visit),
        settled_(settled) {
    for (int i = 0; i < 2; ++i)
      box_[i] = {std::min({corners[0][i], corners[1][i], corners[2][i]}),
                 std::max({corners[0][i], corners[1][i], corners[2][i]})};
  }

  void run() {
    add(kReference, 0, 1);
    for (; !open_.empty() && budget_.cells > 0; --budget_.cells) {
      const Cell cell = open_.top();
      open_.pop();
      if (!cell.values.undecided || !cut_along(cell)) cut_in_halves(cell);
    }
    for (; !open_.empty(); open_.pop()) give_up(open_.top());
  }

 private:
  /// Deeper than this a cell is too small to matter or the formula has a pole.
  static constexpr int kDeepest = 60;

  struct Cell {
    Corners corners;
    int depth;
    double share;
    Values values;
    Doubt doubt;

    bool operator<(const Cell& other) const { return doubt < other.doubt; }
  };

  /// Within the box of the triangle: rounding must not leave the domain of a formula.
  Point physical(const Point& reference) const {
    const Point x = corners_[0] + reference.x() * (corners_[1] - corners_[0]) +
                    reference.y() * (corners_[2] - corners_[0]);
    return {std::clamp(x.x(), box_[0].lower(), box_[0].upper()),
            std::clamp(x.y(), box_[1].lower(), box_[1].upper())};
  }

  Corners physical(const Corners& cell) const {
    return {physical(cell[0]), physical(cell[1]), physical(cell[2])};
  }

  void evaluate(Cell& cell) {
    cell.values = signorini::evaluate(fields_, physical(cell.corners), {});
    const Models& models = cell.values.models;
    if (scales_.empty())
      for (const TaylorModel& model : models) scales_.push_back(scale_of(range(model)));
    for (std::size_t i = 0; i < scales_.size(); ++i)
      cell.doubt += doubt(models[i].remainder() * Interval(-1, 1), scales_[i], cell.share);
  }

  static double scale_of(const Interval& values) {
    return is_known(values) && largest(values) > 0 ? largest(values) : 1;
  }

  void visit(const Cell& cell) const { visit_({cell.corners, cell.share, cell.values.models}); }

  /// What is cut no more. A pole must show: rounding takes it out of the polynomial of a model, which is then
  /// only large, and out of the cells around it, whose corners are rounded.
  void give_up(Cell cell) const {
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (const Formula* formula = fields_[i]->formula(); formula && !is_known(values_around(*formula, cell)))
        cell.values.models[i] = TaylorModel::rough(kAnything);
    visit(cell);
  }

  /// On the cell and what rounding may have parted from it.
  Interval values_around(const Formula& formula, const Cell& cell) const {
    const Corners corners = physical(cell.corners);
    const auto around = [&](int i) {
      const auto [least, most] = std::minmax({corners[0][i], corners[1][i], corners[2][i]});
      const double rounding = kEnclosureRounding * largest(box_[i]);
      const auto [begin, end] = std::pair(box_[i].lower(), box_[i].upper());
      return Series(0, {std::max(least - rounding, begin - kEnclosureRounding * std::abs(begin)),
                        std::min(most + rounding, end + kEnclosureRounding * std::abs(end))});
    };
    Enclosure<Series> enclosure{around(0), around(1), Series(0), Series(0), {}, false};
    return range(formula.evaluate(enclosure));
  }

  /// `of_cell`: the share of what would else be cut.
  void add(const Corners& corners, int depth, double of_cell) {
    budget_.look_around();
    Cell cell{corners, depth, area(corners[0], corners[1], corners[2]), {}, {}};
    if (cell.share == 0 || (settled_ && settled_(corners, cell.share))) return;
    evaluate(cell);
    if (accept_(cell.values.models, cell.share, std::max(cell.share, of_cell))) return visit(cell);
    if (depth == kDeepest) return give_up(std::move(cell));
    open_.push(std::move(cell));
  }

  void add_all(const std::vector<Point>& polygon, int depth, double of_cell = 0) {
    for (std::size_t i = 2; i < polygon.size(); ++i)
      add(Corners{polygon[0], polygon[i - 1], polygon[i]}, depth, of_cell);
  }

  /// The two halves by the middle of side e.
  static std::array<Corners, 2> halves(const Corners& cell, int e) {
    const Point &top = cell[e], &a = cell[(e + 1) % 3], &b = cell[(e + 2) % 3], middle = (a + b) / 2;
    return {Corners{top, a, middle}, Corners{top, middle, b}};
  }

  void cut_in_halves(const Cell& cell) {
    const int side = tells_little(cell) ? side_of_least_doubt(cell) : longest_side(cell);
    for (const Corners& half : halves(cell.corners, side)) add(half, cell.depth + 1, 0);
  }

  int longest_side(const Cell& cell) const {
    const Corners corners = physical(cell.corners);
    const auto length = [&](int e) { return (corners[(e + 1) % 3] - corners[(e + 2) % 3]).squaredNorm(); };
    // clang 14 knows no std::ranges::max of a list.
    constexpr std::array sides{0, 1, 2};
    return *std::ranges::max_element(sides, {}, length);
  }

  /// The polynomial of some field is no better than its values.
  bool tells_little(const Cell& cell) const {
    return std::ranges::any_of(cell.values.models, [](const TaylorModel& model) {
      return model.degree() == 0 && model.remainder() > 0;
    });
  }

  /// So that cells become long beside an edge along which the formula is not smooth.
  int side_of_least_doubt(const Cell& cell) const {
    const auto left = [&](int e) {
      Doubt sum;
      for (const Corners& half : halves(cell.corners, e))
        for (std::size_t i = 0; i < fields_.size(); ++i)
          if (const Formula* formula = fields_[i]->formula()) {
            bool undecided = false;
            sum += doubt(range(series_on_triangle(*formula, physical(half), 0, undecided)), scales_[i],
                         cell.share);
          }
      return sum;
    };
    const std::array<Doubt, 3> all{left(0), left(1), left(2)};
    const int longest = longest_side(cell),
              least = static_cast<int>(std::ranges::min_element(all) - all.begin());
    return all[least] < all[longest] ? least : longest;
  }

  /// Both sides of the line where the argument is 0 but for what is not linear in it, and between them the
  /// strip where its sign is not known. Returns false where that would be too wide.
  bool cut_along(const Cell& cell) {
    const TaylorModel::LinearPart part = cell.values.undecided->linear_part();
    const auto& [a, b, c] = part.at_corners;
    const double unknown = kMargin * (part.below + part.above) / 2, shift = (part.above - part.below) / 2;
    if (!std::isfinite(unknown) || (a == b && a == c)) return false;
    // In the coordinates of the triangle.
    const Corners& corners = cell.corners;
    Eigen::Matrix2d jacobian;
    jacobian << corners[1] - corners[0], corners[2] - corners[0];
    const double determinant = jacobian(0, 0) * jacobian(1, 1) - jacobian(0, 1) * jacobian(1, 0);
    const auto linear = [&, &a = a, &b = b, &c = c](const Point& x) {
      const Vector way = x - corners[0];
      const double u = (jacobian(1, 1) * way.x() - jacobian(0, 1) * way.y()) / determinant,
                   v = (jacobian(0, 0) * way.y() - jacobian(1, 0) * way.x()) / determinant;
      return a + (b - a) * u + (c - a) * v + shift;
    };
    const std::vector<Point> whole(corners.begin(), corners.end());
    const auto above = [&](const Point& x) { return linear(x) - unknown; };
    const auto below = [&](const Point& x) { return -linear(x) - unknown; };
    const std::vector<Point> strip = clip(clip(whole, [&](const Point& x) { return -above(x); }),
                                          [&](const Point& x) { return -below(x); });
    if (unknown > 0 && area(strip) > kWidest * cell.share) return false;
    add_all(clip(whole, above), cell.depth + 1);
    add_all(clip(whole, below), cell.depth + 1);
    if (unknown > 0) add_all(strip, cell.depth + 1, cell.share);
    return true;
  }

  /// Of a cell: a strip that is wider is not worth the pieces beside it.
  static constexpr double kWidest = 0.5;
  /// So that the enclosures on these tell the sign, too.
  static constexpr double kMargin = 1.25;

  std::span<const Field* const> fields_;
  const Corners& corners_;
  std::array<Interval, 2> box_;
  const Acceptance& accept_;
  CellBudget& budget_;
  const std::function<void(const TrianglePiece&)>& visit_;
  const Settled& settled_;
  std::vector<double> scales_;  ///< of the fields' values
  std::priority_queue<Cell> open_;
};

}  // namespace

std::vector<Point> clip(const std::vector<Point>& polygon,
                        const std::function<double(const Point&)>& function) {
  std::vector<Point> inside;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double at_a = function(a), at_b = function(b);
    if (at_a >= 0) inside.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
      inside.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return inside;
}

Series series_on_triangle(const Formula& formula, const Corners& corners, int order, bool& undecided,
                          bool strict) {
  const auto& [a, b, c] = corners;
  const Point centroid = (a + b + c) / 3;
  const auto all = [&, &a = a, &b = b, &c = c](int i) {
    const Interval values(std::min({a[i], b[i], c[i]}), std::max({a[i], b[i], c[i]}));
    return Series::line(order, values, values - centroid[i]);
  };
  Enclosure<Series> enclosure{all(0), all(1), Series(order), Series(order), {}, strict};
  Series series = formula.evaluate(enclosure);
  undecided = enclosure.undecided.has_value();
  return series;
}

std::array<Point, 3> triangle_around(const Eigen::AlignedBox2d& box) {
  const Vector twice = 2 * box.sizes();
  return {box.min(), box.min() + Vector(twice.x(), 0), box.min() + Vector(0, twice.y())};
}

std::vector<Models> branches_on_triangle(std::span<const Field* const> fields, const Corners& corners) {
  Assumptions assumptions;
  std::vector<Models> branches;
  add_branches(fields, corners, assumptions, branches);
  return branches;
}

Acceptance mean_remainder_below(double tolerance) {
  return [tolerance](const Models& models, double share, double of_cell) {
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
