#include "mesh/rectangle.hpp"

#include <cmath>
#include <numbers>

#include "mesh/make_mesh.hpp"

namespace signorini {
namespace {

enum Side { left, right, bottom, top };

/// Numbers the points of the squares row by row, and the centres (pattern `crossed`) behind them.
class Grid {
 public:
  Grid(const Rectangle& domain, const Divisions& squares) : domain_(domain), squares_(squares) {}

  int corner(int i, int j) const { return j * (squares_.x + 1) + i; }
  int centre(int i, int j) const { return corner(0, squares_.y + 1) + j * squares_.x + i; }

  /// The point i/nx, j/ny of the way through the domain; the far sides are met without rounding.
  Point at(double i, double j) const {
    return {along(domain_.origin.x(), domain_.size.x(), i, squares_.x),
            along(domain_.origin.y(), domain_.size.y(), j, squares_.y)};
  }

 private:
  static double along(double origin, double size, double i, int n) {
    return i == n ? origin + size : origin + size * (i / n);
  }

  const Rectangle& domain_;
  const Divisions& squares_;
};

/// Looks at the progress for each row of a grid that has so many squares.
void check_row(int row, const Divisions& squares, Progress* progress) {
  constexpr int often = 4096;
  if (progress && (squares.x >= often || row % (often / squares.x) == 0)) progress->check();
}

std::vector<Point> grid_points(const Grid& grid, const Divisions& squares, Pattern pattern,
                               Progress* progress) {
  std::vector<Point> points;
  points.reserve(static_cast<std::size_t>(grid.centre(0, pattern == Pattern::crossed ? squares.y : 0)));
  for (int j = 0; j <= squares.y; ++j) {
    check_row(j, squares, progress);
    for (int i = 0; i <= squares.x; ++i) points.push_back(grid.at(i, j));
  }
  for (int j = 0; pattern == Pattern::crossed && j < squares.y; ++j) {
    check_row(j, squares, progress);
    for (int i = 0; i < squares.x; ++i) points.push_back(grid.at(i + 0.5, j + 0.5));
  }
  return points;
}

void cut_square(const Grid& grid, int i, int j, Pattern pattern, std::vector<std::array<int, 3>>& triangles) {
  const int a = grid.corner(i, j), b = grid.corner(i + 1, j);
  const int c = grid.corner(i + 1, j + 1), d = grid.corner(i, j + 1);
  if (pattern == Pattern::alternating) pattern = (i + j) % 2 == 0 ? Pattern::right : Pattern::left;
  switch (pattern) {
    case Pattern::right:
      triangles.insert(triangles.end(), {{a, b, c}, {a, c, d}});
      break;
    case Pattern::crossed: {
      const int m = grid.centre(i, j);
      triangles.insert(triangles.end(), {{a, b, m}, {b, c, m}, {c, d, m}, {d, a, m}});
      break;
    }
    default:
      triangles.insert(triangles.end(), {{a, b, d}, {b, c, d}});
  }
}

std::vector<BoundarySegment> sides(const Grid& grid, const Divisions& squares) {
  std::vector<BoundarySegment> segments;
  for (int j = 0; j < squares.y; ++j) {
    segments.push_back({{grid.corner(0, j), grid.corner(0, j + 1)}, left});
    segments.push_back({{grid.corner(squares.x, j), grid.corner(squares.x, j + 1)}, right});
  }
  for (int i = 0; i < squares.x; ++i) {
    segments.push_back({{grid.corner(i, 0), grid.corner(i + 1, 0)}, bottom});
    segments.push_back({{grid.corner(i, squares.y), grid.corner(i + 1, squares.y)}, top});
  }
  return segments;
}

/// The fewest parts of a length that are no longer than `part`; a quotient that is whole but for rounding
/// is taken as whole.
int parts_of(double length, double part) {
  return static_cast<int>(std::max(1.0, std::ceil(length / part * (1 - 1e-12))));
}

}  // namespace

const std::vector<std::string>& rectangle_parts() {
  static const std::vector<std::string> names{"left", "right", "bottom", "top"};
  return names;
}

Divisions divisions(const Rectangle& domain, const MeshRequest& request) {
  if (const auto* given = std::get_if<Divisions>(&request.fineness)) return *given;
  // The longest edge of a square of side a is its diagonal √2 a, or its side where it is cut crosswise.
  const double longest = std::get<LargestEdge>(request.fineness).length;
  const double side = request.pattern == Pattern::crossed ? longest : longest / std::numbers::sqrt2;
  return {parts_of(domain.size.x(), side), parts_of(domain.size.y(), side)};
}

Mesh rectangle_mesh(const Rectangle& domain, const Divisions& squares, Pattern pattern, Progress* progress) {
  const Grid grid(domain, squares);
  std::vector<std::array<int, 3>> triangles;
  const std::size_t of_square = pattern == Pattern::crossed ? 4 : 2;
  triangles.reserve(of_square * squares.x * squares.y);
  for (int j = 0; j < squares.y; ++j) {
    check_row(j, squares, progress);
    for (int i = 0; i < squares.x; ++i) cut_square(grid, i, j, pattern, triangles);
  }
  return make_mesh(grid_points(grid, squares, pattern, progress), std::move(triangles), rectangle_parts(),
                   sides(grid, squares), {}, progress);
}

}  // namespace signorini
