#include "certify/data/law_pieces.hpp"

#include <cmath>

#include "fem/quadrature.hpp"
#include "fem/raviart_thomas.hpp"
#include "fem/small_matrices.hpp"
#include "problem/fields.hpp"

namespace signorini {
int LawPiece::degree_of_rule(int of_fields, double tolerance) const {
  for (const int degree : {2, 4, 5, 6, 8, 10, 18})
    if (degree >= 2 * of_fields &&
        error_of_rule(degree, of_fields) <= std::max(tolerance, 1.5 * errors.back()))
      return degree;
  return 30;
}

std::vector<LawPiece> law_pieces(const Material& material, const std::array<Point, 3>& corners,
                                 const LawTolerance& tolerance, CellBudget& budget) {
  const std::vector<const Field*> fields = different_fields(material);
  const AffineMap map(corners);
  const auto placed = [&](const std::array<Point, 3>& cell) -> std::array<Point, 3> {
    return {map(cell[0]), map(cell[1]), map(cell[2])};
  };
  std::vector<LawPiece> pieces;
  const auto add = [&](const std::array<Point, 3>& cell, double share, const LawQuality& own, bool jumps) {
    pieces.push_back({own, {cell, share, {}}, jumps});
  };
  EnclosedFields last;  // on the cell that was looked at last
  std::array<Point, 3> place = corners;
  const Settled settled = [&](const std::array<Point, 3>& cell, double share) {
    place = placed(cell);
    last = {series_of(fields, place), {}};
    if (last.series.empty()) return false;
    const LawQuality own = quality_of(material, last);
    if (!(own.errors.back() * std::sqrt(share) <= tolerance.smooth)) return false;
    add(cell, share, own, false);
    return true;
  };
  const auto with_models = [&](EnclosedFields enclosed, const std::array<Point, 3>& at,
                               const Models& models) {
    enclosed.branches =
        enclosed.series.empty() ? branches_on_triangle(fields, at) : std::vector<Models>{models};
    return quality_of(material, enclosed);
  };
  const Acceptance accept = [&](const Models& models, double share, double of_cell) {
    const double allowed = last.series.empty() ? tolerance.of_jumps : tolerance.smooth;
    return with_models(last, place, models).errors.back() * share <= allowed * std::sqrt(of_cell);
  };
  const auto visit = [&](const TrianglePiece& piece) {
    const std::array<Point, 3> own = placed(piece.corners);
    const EnclosedFields enclosed{series_of(fields, own), {}};
    add(piece.corners, piece.share, with_models(enclosed, own, piece.models), enclosed.series.empty());
  };
  for_each_piece(fields, corners, accept, budget, visit, settled);
  return pieces;
}

namespace {

/// Nearer than that rounding lets no law be told from a polynomial: a bound that is 0 asks for no more.
constexpr double kLeastTolerance = 1e-12;

/// The least tolerance where the law jumps along a curve, on a few triangles.
constexpr double kToleranceOfJumps = 2e-4;

/// A piece of an elastic body's triangle has thrice the points, of which each takes ten times the work.
CellBudget budget_of_triangle(const Material& material, Progress& progress) {
  return {components(material) == 1 ? 400 : 60, &progress};
}

/// What takes most of the cells is known less well.
void loosen(const std::vector<LawPiece>& pieces, LawTolerance& tolerance) {
  const auto of_jumps = static_cast<std::size_t>(std::ranges::count(pieces, true, &LawPiece::jumps));
  (2 * of_jumps > pieces.size() ? tolerance.of_jumps : tolerance.smooth) *= 10;
}

/// Of a piece on which the law is not known: it counts as if the law were what it is in single points.
void take_as_in_points(const Material& material, const std::array<Point, 3>& corners, LawPiece& piece) {
  const AffineMap map(corners);
  piece.errors.fill(0);
  piece.softest = piece.stiffest = 0;
  for (const Point& reference : triangle_rule().points) {
    const Eigen::VectorXd own = eigenvalues(compliance_at(material, map(piece.place(reference))));
    piece.softest = std::max(piece.softest, own.maxCoeff());
    piece.stiffest = std::max(piece.stiffest, 1 / own.minCoeff());
  }
}

}  // namespace

LawOnMesh::LawOnMesh(const Material& material, const Mesh& mesh, double tolerance, Progress& progress)
    : material_(material),
      mesh_(mesh),
      progress_(progress),
      tolerance_(std::max(tolerance, kLeastTolerance)) {
  const int count = is_constant(material) ? 1 : static_cast<int>(mesh.triangles.size());
  const std::vector<const Field*> fields = fields_of(material);
  for (const Field* field : fields)
    if (!field->is_constant() && !field->formula()) {
      unmet_.push_back(field->name() + " is a function that is known in single points only: give a formula");
      whole_.assign(1, {});
      return;
    }
  whole_.reserve(count);
  for (int t = 0; t < count; ++t) {
    if (t % 64 == 0) progress.check();
    // A law that varies so much on a triangle that it would take too many pieces is known less well.
    std::vector<LawPiece> pieces;
    LawTolerance own_tolerance{tolerance_, std::max(tolerance_, kToleranceOfJumps)};
    for (;; loosen(pieces, own_tolerance)) {
      CellBudget budget = budget_of_triangle(material, progress);
      pieces = law_pieces(material, mesh.corners(t), own_tolerance, budget);
      if (budget.cells > 0 || std::max(own_tolerance.smooth, own_tolerance.of_jumps) >= 1) break;
    }
    for (LawPiece& own : pieces) {
      if (own.is_known()) continue;
      if (unmet_.empty())
        unmet_.push_back("/material is not known to be positive definite and bounded near " +
                         to_string(AffineMap(mesh.corners(t))(own.place({1. / 3, 1. / 3}))) +
                         ": refine the mesh where the law changes so much, or let it change less");
      take_as_in_points(material, mesh.corners(t), own);
    }
    LawPiece whole{pieces.front()};
    for (const LawPiece& own : pieces) {
      for (int k = 0; k < LawPiece::kOrders; ++k) whole.errors[k] = std::max(whole.errors[k], own.errors[k]);
      whole.softest = std::max(whole.softest, own.softest);
      whole.stiffest = std::max(whole.stiffest, own.stiffest);
    }
    if (pieces.size() > 1) tolerances_.emplace(t, own_tolerance);
    whole_.push_back(std::move(whole));
  }
}

std::vector<LawPiece> LawOnMesh::cut(int t) const {
  const auto found = tolerances_.find(t);
  if (found == tolerances_.end()) return {};
  CellBudget budget = budget_of_triangle(material_, progress_);
  std::vector<LawPiece> pieces = law_pieces(material_, mesh_.corners(t), found->second, budget);
  for (LawPiece& own : pieces)
    if (!own.is_known()) take_as_in_points(material_, mesh_.corners(t), own);
  return pieces;
}

}  // namespace signorini
