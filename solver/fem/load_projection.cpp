#include "fem/load_projection.hpp"

#include <algorithm>
#include <cmath>

#include "fem/projection.hpp"
#include "fem/raviart_thomas.hpp"
#include "formula/interval.hpp"

namespace signorini {
namespace {

/// What an integral may be off by, relative to the largest load: what is uncertain is carried to the fixed
/// parts by an estimate that is some thousand times too large.
constexpr ProjectionTolerance kTolerance{1e-9, 5e-6};

/// Where the first try stops along curves: it takes hardly any work, and tells how much a finer one would
/// take.
constexpr double kFirstOfJumps = 5e-2;

/// Of what f has between P1 and P2: if the rest is larger where f jumps, that part is left with it.
constexpr double kMuch = 0.2;

}  // namespace

LoadProjection::LoadProjection(const Problem& problem, const Mesh& mesh, Progress* progress) {
  const VectorField& body = problem.body;
  const int count = static_cast<int>(mesh.triangles.size()), d = components(problem.material);
  ProjectedLoad constant{Eigen::MatrixXd::Zero(d, 6), Eigen::MatrixXd::Zero(d, 6)};
  for (int c = 0; c < body.size(); ++c)
    if (body.fields()[c].is_constant()) constant.projection.row(c).setConstant(body(c, Point::Zero()));
  constant.balanced = constant.projection;
  if (std::ranges::all_of(body.fields(), &Field::is_constant)) {
    all_.push_back(constant);
    return;
  }
  double largest = 0;
  for (int t = 0; t < count; ++t)
    for (int c = 0; c < body.size(); ++c) largest = std::max(largest, std::abs(body(c, mesh.centroid(t))));
  CellBudget budget{20 * count + 100'000, progress};
  all_.assign(count, constant);
  // All triangles along a curve share the budget alike: one that has none left would be off by as much as f.
  int of_curves = 0;
  for (int t = 0; t < count; ++t) {
    if (progress && t % 64 == 0) progress->check();
    const int before = budget.cells;
    project_on(body, mesh.corners(t), largest, kFirstOfJumps, budget, all_[t]);
    if (all_[t].uncertain_force > 0) of_curves += before - budget.cells;
  }
  // Cells are as many as one by the root of the tolerance.
  const double finest = kFirstOfJumps * std::pow(of_curves / (0.8 * std::max(1, budget.cells)), 2);
  const double of_jumps = std::max(kTolerance.of_jumps, finest);
  for (int t = 0; t < count && of_jumps < kFirstOfJumps; ++t) {
    const double area = AffineMap(mesh.corners(t)).determinant / 2;
    if (all_[t].uncertain_force <= of_jumps * largest * area) continue;
    all_[t] = constant;
    project_on(body, mesh.corners(t), largest, of_jumps, budget, all_[t]);
  }
}

void LoadProjection::project_on(const VectorField& body, const std::array<Point, 3>& corners, double largest,
                                double of_jumps, CellBudget& budget, ProjectedLoad& load) {
  const double twice_area = AffineMap(corners).determinant;
  double rest_square = 0, unbalanced_square = 0;
  for (int c = 0; c < body.size(); ++c) {
    const Field& field = body.fields()[c];
    if (field.is_constant()) continue;
    if (!field.formula() && unmet_.empty())
      unmet_.push_back(field.name() + " is a function that is known in single points only: give a formula");
    const Projection own = project(field, corners, {kTolerance.smooth * largest, of_jumps * largest}, budget);
    if (!own.is_finite && unmet_.empty())
      unmet_.push_back(field.name() + " is not known to be finite near " +
                       to_string((corners[0] + corners[1] + corners[2]) / 3));
    const bool leaves = own.jumps && own.rest > kMuch * own.between;
    load.jumps = load.jumps || leaves;
    load.projection.row(c) = own.quadratic;
    load.balanced.row(c) = leaves ? own.linear : own.quadratic;
    load.uncertain_force += twice_area * own.uncertain_force;
    load.uncertain_work += twice_area * own.uncertain_work;
    // Below this the rest is rounding.
    if (own.rest <= kEnclosureRounding * largest) continue;
    const double unbalanced = leaves ? own.beyond_linear : own.rest;
    rest_square += twice_area * own.rest * own.rest;
    unbalanced_square += twice_area * unbalanced * unbalanced;
  }
  load.rest = std::sqrt(rest_square);
  load.unbalanced = std::sqrt(unbalanced_square);
}

}  // namespace signorini
