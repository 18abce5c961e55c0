#include "fem/load_projection.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "fem/projection.hpp"
#include "fem/raviart_thomas.hpp"
#include "formula/interval.hpp"

namespace signorini {
namespace {

/// What an integral may be off by, relative to the largest load.
constexpr ProjectionTolerance kTolerance{1e-9, 2e-5, 100 * kEnclosureRounding};

/// Of each triangle: enough where the load is smooth, or jumps along a straight line.
constexpr int kFirstCells = 4;

/// Of all the others together, for a formula of a few operations.
constexpr int kCellsOfRoughLoads = 20'000;

/// So many triangles, mostly neighbours, are looked at together before each is by itself.
constexpr int kNeighbours = 64;

/// The load where that has the same value all over a box, as beside a jump: most loads do not vary else.
/// Returns false if it may vary there.
bool is_constant_on(const VectorField& body, const Eigen::AlignedBox2d& box, double largest,
                    ProjectedLoad& load) {
  for (int c = 0; c < body.size(); ++c) {
    const std::optional<double> value = constant_on(body.fields()[c], box, kTolerance.rounding * largest);
    if (!value) return false;
    load.projection.row(c).setConstant(*value);
  }
  load.balanced = load.projection;
  return true;
}

Eigen::AlignedBox2d box_around(const Mesh& mesh, int begin, int end) {
  Eigen::AlignedBox2d box;
  for (int t = begin; t < end; ++t)
    for (const int point : mesh.triangles[t]) box.extend(mesh.points[point]);
  return box;
}

double largest_at_centroids(const VectorField& body, const Mesh& mesh, Progress& progress) {
  double largest = 0;
  in_parts(
      static_cast<int>(mesh.triangles.size()), progress,
      [&](Part part, Progress& own) {
        double found = 0;
        for (int t = part.begin; t < part.end; ++t) {
          own.check_in(t);
          for (int c = 0; c < body.size(); ++c) found = std::max(found, std::abs(body(c, mesh.centroid(t))));
        }
        return found;
      },
      [&](double found) { largest = std::max(largest, found); });
  return largest;
}

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
    found_.all.push_back(constant);
    return;
  }
  Observer nobody;
  Progress alone(nobody, std::nullopt);
  Progress& its = progress ? *progress : alone;
  const double largest = largest_at_centroids(body, mesh, its);
  found_.number_of.reserve(count);
  in_parts(
      count, its, [&](Part part, Progress& own) { return find(body, mesh, constant, largest, part, own); },
      [&](Found found) { found_.append(std::move(found)); });
  // One that has no cells would be off by as much as f.
  const std::vector<int> rough = std::exchange(found_.rough, {});
  CellBudget budget{kCellsOfRoughLoads + kFirstCells * count, progress};
  for (std::size_t i = 0; i < rough.size(); ++i) {
    ProjectedLoad& load = found_.all[found_.number_of[rough[i]]];
    budget.share(
        rough.size() - i,
        [&](CellBudget& own) { project_on(body, mesh.corners(rough[i]), largest, own, load, found_.unmet); },
        kCellsOfRoughLoads);
  }
}

LoadProjection::Found LoadProjection::find(const VectorField& body, const Mesh& mesh,
                                           const ProjectedLoad& constant, double largest, Part part,
                                           Progress& progress) {
  Found found;
  for (int begin = part.begin; begin < part.end; begin += kNeighbours) {
    progress.check();
    const int end = std::min(begin + kNeighbours, part.end);
    ProjectedLoad of_all = constant;
    const bool is_constant = is_constant_on(body, box_around(mesh, begin, end), largest, of_all);
    for (int t = begin; t < end; ++t) {
      if (is_constant) {
        found.take(of_all);
        continue;
      }
      ProjectedLoad own = constant;
      CellBudget budget{kFirstCells * body.size(), &progress};
      const std::vector<std::string> known = found.unmet;
      if (project_on(body, mesh.corners(t), largest, budget, own, found.unmet)) {
        found.take(std::move(own));
        continue;
      }
      // It is to be made anew: more cells may tell what a few do not.
      found.take(constant, false);
      found.rough.push_back(t);
      found.unmet = known;
    }
  }
  return found;
}

void LoadProjection::Found::take(ProjectedLoad load, bool may_be_shared) {
  if (all.empty()) first_may_be_shared = may_be_shared;
  if (!may_be_shared || !last_may_be_shared || all.back() != load) all.push_back(std::move(load));
  number_of.push_back(static_cast<int>(all.size()) - 1);
  last_may_be_shared = may_be_shared;
}

void LoadProjection::Found::append(Found next) {
  const bool is_shared = last_may_be_shared && next.first_may_be_shared && all.back() == next.all.front();
  const int first = static_cast<int>(all.size()) - (is_shared ? 1 : 0);
  std::move(next.all.begin() + (is_shared ? 1 : 0), next.all.end(), std::back_inserter(all));
  for (const int number : next.number_of) number_of.push_back(first + number);
  last_may_be_shared = next.last_may_be_shared;
  rough.insert(rough.end(), next.rough.begin(), next.rough.end());
  if (unmet.empty()) unmet = std::move(next.unmet);
}

ProjectedLoad ProjectedLoad::plus(double z, const ProjectedLoad& other) const {
  const double size = std::abs(z);
  return {projection + z * other.projection,
          balanced + z * other.balanced,
          rest + size * other.rest,
          unbalanced + size * other.unbalanced,
          uncertain_force + size * other.uncertain_force,
          uncertain_work + size * other.uncertain_work,
          jumps || other.jumps};
}

bool LoadProjection::project_on(const VectorField& body, const std::array<Point, 3>& corners, double largest,
                                CellBudget& budget, ProjectedLoad& load, std::vector<std::string>& unmet) {
  const double twice_area = AffineMap(corners).determinant;
  double rest_square = 0, unbalanced_square = 0;
  bool is_enough = true;
  for (int c = 0; c < body.size(); ++c) {
    const Field& field = body.fields()[c];
    if (field.is_constant()) continue;
    if (!field.formula() && unmet.empty())
      unmet.push_back(field.name() + " is a function that is known in single points only: give a formula");
    Projection own;
    budget.share(body.size() - c, [&](CellBudget& part) {
      own = project(field, corners,
                    {kTolerance.fine * largest, kTolerance.rough * largest, kTolerance.rounding * largest},
                    part);
      is_enough = is_enough && part.cells > 0;
    });
    if (!own.is_finite && unmet.empty())
      unmet.push_back(not_known_to_be_finite(field, (corners[0] + corners[1] + corners[2]) / 3));
    const bool leaves = own.jumps && own.rest > std::max(kMuch * own.between, kEnclosureRounding * largest);
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
  return is_enough;
}

}  // namespace signorini
