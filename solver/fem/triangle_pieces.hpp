#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <span>

#include <Eigen/Geometry>

#include "formula/series.hpp"
#include "formula/taylor_model.hpp"
#include "problem/field.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// The Taylor coefficients in t of f(x_T + t (x − x_T)) for all t ∈ [0, 1] and all points x of the triangle
/// at once, x_T its centroid. `undecided` tells whether a jump or a kink may lie in it. `strict`: Enclosure.
Series series_on_triangle(const Formula& formula, const std::array<Point, 3>& corners, int order,
                          bool& undecided, bool strict = false);

/// A triangle that holds a box.
std::array<Point, 3> triangle_around(const Eigen::AlignedBox2d& box);

/// The models of fields, constants or formulas, on a cell.
using Models = std::vector<TaylorModel>;

/// A list of models for each way in which that may be decided, the same for all fields, which is not on the
/// cell: in (almost) every point the fields have the values of one of them together. What would take many is
/// not decided.
std::vector<Models> branches_on_triangle(std::span<const Field* const> fields,
                                         const std::array<Point, 3>& corners);

/// A part of a triangle on which formulas are polynomials but for a remainder.
struct TrianglePiece {
  std::array<Point, 3> corners;  ///< in the reference coordinates of the triangle
  double share = 1;              ///< of the triangle's area
  Models models;                 ///< an entry a field; in the reference coordinates of the piece

  /// From the reference coordinates of the piece to those of the triangle.
  Point operator()(const Point& own) const {
    return corners[0] + own.x() * (corners[1] - corners[0]) + own.y() * (corners[2] - corners[0]);
  }
};

/// How many cells may still be made for the formulas of one problem. To enclose a formula in many takes
/// seconds: a progress, if there is one, is asked in each.
struct CellBudget {
  int cells;
  Progress* progress = nullptr;

  /// Lets `use` have one of so many equal parts, but no more than `most`, for those of one use are in memory
  /// together. What it leaves, the others have.
  template <typename Use>
  void share(std::size_t parts, const Use& use, int most = std::numeric_limits<int>::max()) {
    const int own = std::min(cells / static_cast<int>(parts), most);
    CellBudget part{own, progress};
    use(part);
    cells -= own - part.cells;
  }

  /// Throws what the progress throws.
  void look_around() const {
    if (progress) progress->check();
  }
};

/// The part of a convex polygon where a linear function is not negative.
std::vector<Point> clip(const std::vector<Point>& polygon,
                        const std::function<double(const Point&)>& function);

/// Whether a part of a cell may stay as it is, with these models of the fields: `share` of the triangle is
/// the part's, `of_cell` that of the cell which would else be cut. Cells along a curve are 2ⁿ of the size
/// 2⁻ⁿ: the sum over them is that of a single one if each is allowed the root of its share.
using Acceptance = std::function<bool(const Models& models, double share, double of_cell)>;

/// The means of the remainders add up to about `tolerance`, a value of the fields.
Acceptance mean_remainder_below(double tolerance);

/// Whether nothing more is to be said of a cell, in the reference coordinates of the triangle.
using Settled = std::function<bool(const std::array<Point, 3>& cell, double share)>;

/// Cuts a triangle into pieces until they are settled, accepted, or the budget is used up: along the lines
/// where a comparison changes or a kink lies, as far as they are straight, else into halves; first those of
/// which least is known. A straight jump leaves nothing over. All fields must be constants or formulas.
void for_each_piece(std::span<const Field* const> fields, const std::array<Point, 3>& corners,
                    const Acceptance& accept, CellBudget& budget,
                    const std::function<void(const TrianglePiece&)>& visit, const Settled& settled = {});

}  // namespace signorini
