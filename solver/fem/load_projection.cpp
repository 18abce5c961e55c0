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
constexpr double kTolerance = 1e-9;

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
  for (int t = 0; t < count; ++t) {
    if (progress && t % 64 == 0) progress->check();
    const double twice_area = AffineMap(mesh.corners(t)).determinant;
    double rest_square = 0, unbalanced_square = 0;
    for (int c = 0; c < d; ++c) {
      const Field& field = body.fields()[c];
      if (field.is_constant()) continue;
      if (!field.formula() && unmet_.empty())
        unmet_.push_back(field.name() + " is a function that is known in single points only: give a formula");
      const Projection own = project(field, mesh.corners(t), kTolerance * largest, budget);
      if (!own.is_finite && unmet_.empty())
        unmet_.push_back(field.name() + " is not known to be finite near " + to_string(mesh.centroid(t)));
      const bool leaves = own.jumps && own.rest > kMuch * own.between;
      all_[t].jumps = all_[t].jumps || leaves;
      all_[t].projection.row(c) = own.quadratic;
      all_[t].balanced.row(c) = leaves ? own.linear : own.quadratic;
      all_[t].uncertain_force += twice_area * own.uncertain_force;
      all_[t].uncertain_work += twice_area * own.uncertain_work;
      // Below this the rest is rounding.
      if (own.rest <= kEnclosureRounding * largest) continue;
      const double unbalanced = leaves ? own.beyond_linear : own.rest;
      rest_square += twice_area * own.rest * own.rest;
      unbalanced_square += twice_area * unbalanced * unbalanced;
    }
    all_[t].rest = std::sqrt(rest_square);
    all_[t].unbalanced = std::sqrt(unbalanced_square);
  }
}

}  // namespace signorini
