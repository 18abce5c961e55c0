#include "factor_estimate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "fem/per_shape.hpp"
#include "mesh/corner_order.hpp"
#include "mesh/edge_table.hpp"
#include "progress/observer.hpp"
#include "progress/progress.hpp"
#include "system/dissection.hpp"
#include "system/lower_triangle.hpp"
#include "system/repeated_pieces.hpp"
#include "system/short_cut.hpp"

namespace signorini {
namespace {

constexpr double kValue = sizeof(double), kUnknown = sizeof(int);

/// A direction of the pieces into which a dissection cuts squares.
struct Direction {
  double squares;        ///< of one piece
  double width;          ///< of a square
  bool has_neighbours;   ///< the whole, on both sides
  double pieces = 1;     ///< side by side
  bool straight = true;  ///< all cuts so far went between squares

  void halve(bool between_squares) {
    straight = straight && between_squares;
    squares /= 2;
    pieces *= 2;
  }
  double extent() const { return squares * width; }
  /// Of the two sides that a piece has along this direction's cuts those that are not on the boundary.
  double inner_sides() const { return has_neighbours ? 2 : 2 * (pieces - 1) / pieces; }
  /// The same of the piece with the most.
  double most_inner_sides() const { return has_neighbours ? 2 : std::min(2., pieces - 1); }
};

/// What a cut through squares takes more edges, and what the sides of a piece have more, than those between
/// squares.
constexpr double kThrough = 1.5, kRagged = 1.3;

/// Of all pieces of a level so many differ from each other where squares are of so many kinds: by the sides
/// that they have on the boundary, and the order in which the others are cut. As measured of thousands of
/// squares.
double different_pieces(int level, int kinds) {
  return kinds == 0 ? std::exp2(level) : std::min(std::exp2(level), kinds * (12. + 4 * level));
}

/// Of each level of pieces the unknowns on the cut and on the sides, as all pieces of a level are alike.
FactorBytes of_squares(Direction x, Direction y, bool is_regular, int kinds, const Spaces& spaces,
                       double all_triangles, double contact, double upright) {
  constexpr double least_in_leaf = 8;
  const double per_edge = spaces.traces_per_edge(), per_point = spaces.rotations() ? 1 : 0;
  const int levels = static_cast<int>(std::log2(std::max(1., all_triangles / least_in_leaf)));
  FactorBytes all;
  for (int level = 0; level <= levels; ++level) {
    const double pieces = std::exp2(level);
    const double triangles = all_triangles / pieces;
    const double ragged_x = x.straight ? 1 : kRagged, ragged_y = y.straight ? 1 : kRagged;
    const double sides = ragged_x * x.inner_sides() * y.squares + ragged_y * y.inner_sides() * x.squares;
    const bool are_few = triangles < ShortCut::kFew;
    const bool along_x = are_few ? x.extent() >= y.extent() : x.squares >= y.squares;
    Direction& longer = along_x ? x : y;
    double pivots = 0;
    if (level < levels) {
      pivots = (is_regular ? 1 : kThrough) * (along_x ? y : x).squares * (per_edge + per_point);
    } else {
      pivots =
          std::max(0., (3 * triangles - sides) / 2 * per_edge + ((triangles - sides) / 2 + 1) * per_point);
    }
    const double rest = sides * (per_edge + per_point) + contact / pieces;
    const double kept = different_pieces(level, kinds);
    all.panels += kValue * kept * pivots * (pivots + rest);
    all.fronts += kUnknown * pieces * (pivots + rest);
    // The largest piece of the level, which has all its sides inside, and perhaps all of the contact that
    // this level's cuts do not cut.
    const double most =
        ragged_x * x.most_inner_sides() * y.squares + ragged_y * y.most_inner_sides() * x.squares;
    const double largest =
        most * (per_edge + per_point) + contact * ((1 - upright) / x.pieces + upright / y.pieces);
    all.stacks += kValue * (level > 0 ? 2 : 1) * numbers_of_lower_triangle(largest);
    longer.halve(is_regular);
  }
  return all;
}

/// The components of the trace that are unknown on an edge.
int traces_on(const Condition* condition, int components) {
  if (condition == nullptr) return components;
  if (std::holds_alternative<Fixed>(*condition)) return 0;
  const bool normal_is_known =
      std::holds_alternative<Roller>(*condition) || std::holds_alternative<Contact>(*condition);
  return normal_is_known ? components - 1 : components;
}

bool exist(const std::array<int, 3>& numbers, const std::vector<Point>& points) {
  return std::ranges::all_of(numbers, [&](int i) { return i >= 0 && i < static_cast<int>(points.size()); });
}

/// The number of the corner of a triangle that is not on its side; any of a triangle that has a point twice,
/// which is for the solve to refuse.
int opposite(const std::array<int, 3>& triangle, const std::array<int, 2>& side) {
  const auto corner = std::find_if(triangle.begin(), triangle.end() - 1,
                                   [&](int point) { return std::ranges::count(side, point) == 0; });
  return static_cast<int>(corner - triangle.begin());
}

/// Triangles of the same shape have the number of one of them.
void number_shapes(const std::vector<Point>& points, const std::vector<std::array<int, 3>>& triangles,
                   std::vector<int>& number_of) {
  if (triangles.empty()) return;
  const auto map_of = [&](const std::array<int, 3>& own) {
    return AffineMap({points[own[0]], points[own[1]], points[own[2]]});
  };
  // Of triangles without a width nothing is alike: they are for the solve to refuse.
  const AffineMap first = map_of(triangles[0]);
  if (first.determinant == 0) return;
  ShapeMemory<int> shapes(first);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    number_of[t] = shapes(map_of(triangles[t]).jacobian, [t] { return t; });
}

bool has_sides_along_axes(const std::array<int, 3>& triangle, const std::vector<Point>& points) {
  constexpr double rounding = 1e-9;
  std::array<bool, 2> along{};
  for (int i = 0; i < 3; ++i) {
    const Vector side = points[triangle[(i + 1) % 3]] - points[triangle[i]];
    for (int axis = 0; axis < 2; ++axis)
      along[axis] = along[axis] || std::abs(side[1 - axis]) <= rounding * std::abs(side[axis]);
  }
  return along[0] && along[1];
}

std::array<int, 2> ascending(const std::array<int, 2>& edge) {
  return {std::min(edge[0], edge[1]), std::max(edge[0], edge[1])};
}

}  // namespace

FactorBytes factor_bytes(const Grid& grid, const Spaces& spaces, double triangles, double contact_unknowns) {
  return of_squares({grid.x, grid.width, false}, {grid.y, grid.height, false}, grid.is_regular, grid.kinds,
                    spaces, triangles, contact_unknowns, grid.upright);
}

MeshPieces::MeshPieces(const std::vector<Point>& points, std::vector<std::array<int, 3>> triangles,
                       const std::vector<std::pair<const Condition*, const Edges*>>& boundary, int components,
                       bool alike)
    : triangles_(static_cast<double>(triangles.size())) {
  if (!std::ranges::all_of(triangles, [&](const auto& triangle) { return exist(triangle, points); })) return;
  for (std::array<int, 3>& triangle : triangles) triangle = in_order(triangle, points);
  std::vector<std::pair<std::array<int, 2>, const Condition*>> conditions;
  for (const auto& [condition, edges] : boundary)
    for (const auto& edge : *edges) conditions.emplace_back(ascending(edge), condition);
  std::ranges::sort(conditions);

  // The unknowns of the dissection: two an edge, at its ends, which neighbours have in turn, one a point, and
  // one for each edge that is contact; in an element by the corners, so that the elements of one shape have
  // theirs in one order.
  constexpr int nowhere = -1, at_ends = 2, ends_at = 0, points_at = 6, contact_at = 9, per_element = 12;
  ElementSum sum;
  sum.per_element = per_element;
  sum.unknowns.assign(per_element * triangles.size(), nowhere);
  sum.matrix_of.resize(triangles.size());
  const auto place = [&](int triangle, int at) -> int& {
    return sum.unknowns[per_element * static_cast<std::size_t>(triangle) + at];
  };
  // As assemble() numbers them: by their shapes, and by the sides on which their traces are turned.
  std::iota(sum.matrix_of.begin(), sum.matrix_of.end(), 0);
  if (alike) number_shapes(points, triangles, sum.matrix_of);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) shapes_ += sum.matrix_of[t] == t ? 1 : 0;
  constexpr double of_lattice = 2;
  is_lattice_ = shapes_ <= of_lattice && !triangles.empty() && has_sides_along_axes(triangles[0], points);
  for (int& number : sum.matrix_of) number *= 8;
  std::vector<int> traces;
  std::vector<TriangleEdge> contact;
  std::vector<std::array<int, 3>> edges_of(triangles.size());
  int edges = 0;
  const auto corner_opposite = [&](const TriangleEdge& side) {
    return opposite(triangles[side.triangle], side.points);
  };
  EdgeTable(triangles).for_each_edge([&](const auto& sides) {
    if (sides.size() == 1) ++boundary_edges_;
    for (const TriangleEdge& side : sides) edges_of[side.triangle][corner_opposite(side)] = edges;
    ++edges;
    const auto known =
        std::ranges::lower_bound(conditions, sides[0].points, {}, &decltype(conditions)::value_type::first);
    const Condition* const condition =
        sides.size() == 1 && known != conditions.end() && known->first == sides[0].points ? known->second
                                                                                          : nullptr;
    if (const int unknown = traces_on(condition, components); unknown > 0) {
      const int first = static_cast<int>(traces.size());
      for (const TriangleEdge& side : sides)
        for (int end = 0; end < at_ends; ++end)
          place(side.triangle, ends_at + at_ends * corner_opposite(side) + end) =
              first + (side.forward ? end : 1 - end);
      traces.insert(traces.end(), at_ends, unknown);
      if (unknown < components) sum.matrix_of[sides[0].triangle] += 1 << corner_opposite(sides[0]);
    }
    if (condition != nullptr && std::holds_alternative<Contact>(*condition)) contact.push_back(sides[0]);
  });
  const int with_traces = static_cast<int>(traces.size());
  const int with_rotation = components == 2 ? static_cast<int>(points.size()) : 0;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    const auto& [a, b, c] = triangles[t];
    sum.centres.push_back((points[a] + points[b] + points[c]) / 3);
    for (int i = 0; i < 3 && with_rotation > 0; ++i) place(t, points_at + i) = with_traces + triangles[t][i];
  }
  for (int i = 0; i < static_cast<int>(contact.size()); ++i)
    place(contact[i].triangle, contact_at + corner_opposite(contact[i])) = with_traces + with_rotation + i;
  sum.size = with_traces + with_rotation + static_cast<int>(contact.size());
  contact_edges_ = static_cast<double>(contact.size());

  Observer nobody;
  Progress progress(nobody, {});
  sum.tree = tree_by_edges(sum.centres, edges_of, progress);
  const Dissection dissection(sum, static_cast<int>(contact.size()), progress);
  const RepeatedPieces like(dissection, sum, progress);
  std::vector<int> numbers(dissection.pieces(), 0);
  const auto share_of = [&](std::span<const int> unknowns) {
    Share share;
    for (const int unknown : unknowns) {
      if (unknown < with_traces)
        share.traces += traces[unknown] / static_cast<double>(at_ends);
      else
        (unknown < with_traces + with_rotation ? share.points : share.contact) += 1;
    }
    return share;
  };
  dissection.for_each_piece([&](int piece) {
    const Dissection::Front front = dissection.front(piece);
    const bool is_leaf = dissection.is_leaf(piece);
    numbers[piece] = static_cast<int>(pieces_.size());
    const std::array<int, 2> halves =
        is_leaf ? std::array{0, 0} : std::array{numbers[2 * piece], numbers[2 * piece + 1]};
    pieces_.push_back({share_of(front.unknowns.first(front.pivots)), share_of(front.remaining()),
                       static_cast<int>(std::bit_width(static_cast<unsigned>(piece)) % 2), is_leaf,
                       numbers[like.original(piece)], like.uses(piece), halves, Vector(1, 1), 1});
    if (!is_leaf) return;
    Eigen::AlignedBox2d all;
    Vector sum_of_own = Vector::Zero();
    for (const int t : dissection.elements(piece)) {
      Eigen::AlignedBox2d own;
      for (const int point : triangles[t]) own.extend(points[point]);
      all.extend(own);
      sum_of_own += own.sizes();
    }
    pieces_.back().extent = all.sizes();
    // Triangles without a width are for the solve to refuse.
    if (sum_of_own.minCoeff() > 0)
      pieces_.back().across = all.sizes().x() / sum_of_own.x() / (all.sizes().y() / sum_of_own.y());
  });
}

/// The parts of a triangle have two, one turned round.
double MeshPieces::shapes(double triangles) const {
  return std::min(triangles, (triangles > triangles_ ? 2 : 1) * shapes_);
}

/// By how many times more than it was foreseen of the coarser mesh the panels are of this one. Cuts along the
/// axes are the longer, the finer a mesh is whose triangles are thin and lie askew.
double MeshPieces::worsening(const Spaces& spaces, double contact_unknowns) const {
  return factor_bytes(spaces, triangles_, contact_unknowns, false).panels /
         coarser_->factor_bytes(spaces, triangles_, contact_unknowns, false).panels;
}

/// By how many times the edges of a leaf that is refined to so many triangles are more than those of squares,
/// 3/2 of a triangle: where its own are, because many lie on the boundary. Each edge becomes two, and each
/// triangle has three more inside.
double MeshPieces::fullness(const Piece& leaf, const Spaces& spaces, double triangles) const {
  constexpr double of_square = 1.5;
  const double own = triangles_ / (static_cast<double>(pieces_.size() + 1) / 2);
  const double more = std::max(0., leaf.cut.traces / spaces.components - of_square * own);
  return 1 + more * std::sqrt(triangles / own) / (of_square * triangles);
}

/// A leaf with so many triangles more than a leaf has: its squares are cut as it lies there.
FactorBytes MeshPieces::within(const Piece& leaf, const Spaces& spaces, double triangles,
                               double contact) const {
  const double x = std::sqrt(triangles / 2 * leaf.across), y = triangles / 2 / x;
  FactorBytes made = of_squares({x, leaf.extent.x() / x, true}, {y, leaf.extent.y() / y, true}, false, 0,
                                spaces, triangles, contact, 0);
  const double full = fullness(leaf, spaces, triangles);
  made.panels *= full * full, made.stacks *= full * full, made.fronts *= full;
  return made;
}

FactorBytes MeshPieces::factor_bytes(const Spaces& spaces, double triangles, double contact_unknowns,
                                     bool repeated) const {
  repeated = repeated && (triangles <= triangles_ || is_lattice_);
  const double growth = std::sqrt(triangles / triangles_),
               leaves = static_cast<double>(pieces_.size() + 1) / 2;
  const double per_contact = contact_edges_ > 0 ? contact_unknowns / contact_edges_ : 0;
  const auto free = [&](const Share& share) {
    return growth * ((spaces.order + 1) * share.traces + share.points);
  };
  const auto rim_of = [&](const Piece& piece) { return free(piece.rim) + per_contact * piece.rim.contact; };
  FactorBytes all;
  double stacks_of_leaf = 0;
  std::array<double, 2> stacks{}, largest{};
  double shared = 0, most_shared = 0;
  const auto original_of = [&](int i) { return repeated ? pieces_[i].original : i; };
  std::vector<int> uses, uses_left;
  for (const Piece& piece : pieces_) uses.push_back(repeated ? piece.uses : 1);
  uses_left = uses;
  for (int i = 0; i < static_cast<int>(pieces_.size()); ++i) {
    const Piece& piece = pieces_[i];
    const double rim = rim_of(piece), pivots = free(piece.cut);
    const bool is_original = original_of(i) == i, has_inside = piece.is_leaf && growth > 1;
    const FactorBytes inside =
        has_inside ? within(piece, spaces, triangles / leaves, per_contact * piece.rim.contact)
                   : FactorBytes{kValue * pivots * (pivots + rim), kUnknown * (pivots + rim), 0};
    all.fronts += inside.fronts;
    if (!is_original) continue;
    all.panels += inside.panels;
    stacks_of_leaf = std::max(stacks_of_leaf, inside.stacks);
    // As multifrontal() keeps them: one stack for a piece, the other for its halves, and what several take
    // in.
    (uses[i] > 1 ? shared : stacks[piece.parity]) += numbers_of_lower_triangle(rim);
    most_shared = std::max(most_shared, shared);
    largest[piece.parity] = std::max(largest[piece.parity], stacks[piece.parity]);
    if (piece.is_leaf) continue;
    for (const int half : piece.halves) {
      const int original = original_of(half);
      const double left = numbers_of_lower_triangle(rim_of(pieces_[original]));
      if (uses[original] <= 1)
        stacks[1 - piece.parity] -= left;
      else if (--uses_left[original] == 0)
        shared -= left;
    }
  }
  all.stacks = kValue * (largest[0] + largest[1] + most_shared) + stacks_of_leaf;
  // With many edges on the boundary a refinement is cut elsewhere, and what was alike is so no more: by so
  // much, as measured.
  constexpr double ragged = 0.15, of_alike = 2.7, of_others = 1.2;
  if (growth > 1 && boundary_edges_ > ragged * triangles_)
    all.panels = repeated ? std::min(of_alike * all.panels,
                                     factor_bytes(spaces, triangles, contact_unknowns, false).panels)
                          : of_others * all.panels;
  if (growth > 1 && !repeated && coarser_) {
    constexpr double once_more = 1.3;  // as measured of grids and rings of thin triangles
    const double worse = once_more * std::max(1., worsening(spaces, contact_unknowns / growth));
    all.panels *= worse, all.stacks *= worse;
  }
  return all;
}

}  // namespace signorini
