#include "certify/patches/patch_pairs.hpp"

#include <algorithm>
#include <limits>

#include "certify/displacement/relaxation.hpp"
#include "certify/membrane/stream_function_minimization.hpp"

namespace signorini {
namespace {

/// A scalar on the cut. `value` takes an edge of the whole mesh, s ∈ [0, 1] on it and the normal.
VectorField on_cut(const Mesh& mesh, const std::vector<int>& cut,
                   std::function<double(int edge, double s, const Vector& normal)> value) {
  const auto at_nearest = [&mesh, &cut, value = std::move(value)](const Point& x, const Vector& normal) {
    double least = std::numeric_limits<double>::infinity(), s_there = 0;
    int nearest = -1;
    for (const int edge : cut) {
      const Point &a = mesh.points[mesh.edges[edge][0]], &b = mesh.points[mesh.edges[edge][1]];
      const double s = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0., 1.);
      const double distance = (a + s * (b - a) - x).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      s_there = s;
      nearest = edge;
    }
    return value(nearest, s_there, normal);
  };
  return Field::quadratic_on_edges(at_nearest, "the certificate's patch");
}

Fixed displacement_on_cut(const Discretization& whole, const AdmissibleDisplacement& v, const Patch& patch) {
  return {on_cut(whole.mesh, patch.cut,
                 [&v](int edge, double s, const Vector&) { return v.on_edge(edge, s)[0]; })};
}

/// σ*n as the triangle of the patch behind the cut has it.
Traction traction_on_cut(const Discretization& whole, const Eigen::MatrixXd& stress,
                         const AdmissiblePair& pair, const Patch& patch) {
  const Mesh& mesh = whole.mesh;
  std::vector<bool> inside(mesh.triangles.size(), false);
  for (const int t : patch.parents) inside[t] = true;
  return {on_cut(mesh, patch.cut, [&, inside](int edge, double s, const Vector& normal) {
    const auto& [one, other] = mesh.edge_triangles[edge];
    const int t = inside[one] ? one : other;
    const AffineMap map(mesh.corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    const auto& [a, b] = mesh.edges[edge];
    const Point x = mesh.points[a] + s * (mesh.points[b] - mesh.points[a]);
    const Point reference = inverse * (x - map.origin);
    const Vector sigma = whole.spaces().row.values(map, reference) * stress.col(t);
    const Eigen::RowVector2d rise =
        pair.stream_function_on(mesh, t) * quadratic_gradients(reference).transpose();
    return normal.dot(sigma + curl(inverse, rise));
  })};
}

/// σ_h in the basis of the triangles of the patch.
Eigen::MatrixXd on_patch(const Discretization& whole, const Eigen::MatrixXd& stress, const Patch& patch) {
  const RaviartThomas& row = whole.spaces().row;
  Eigen::MatrixXd all(stress.rows(), static_cast<Eigen::Index>(patch.parents.size()));
  for (int t = 0; t < static_cast<int>(patch.parents.size()); ++t) {
    const int parent = patch.parents[t];
    const AffineMap around(whole.mesh.corners(parent));
    const Eigen::Matrix2d inverse = around.jacobian.inverse();
    all.col(t) = row.interpolate(AffineMap(patch.mesh->corners(t)), [&](const Point& x) -> Vector {
      return row.values(around, inverse * (x - around.origin)) * stress.col(parent);
    });
  }
  return all;
}

}  // namespace

PatchPairs::PatchPairs(const Discretization& whole, const Eigen::MatrixXd& stress, const AdmissiblePair& pair,
                       Patch patch, Progress& progress)
    : patch_(std::move(patch)),
      held_(whole, patch_, displacement_on_cut(whole, pair.v, patch_), progress),
      loaded_(whole, patch_, traction_on_cut(whole, stress, pair, patch_), progress),
      stress_(on_patch(whole, stress, patch_)),
      change_(loaded_.solution().stress - stress_),
      first_(first_pair(progress)),
      second_(second_pair(progress)) {}

bool PatchPairs::are_admissible() const {
  return loaded_.is_balanced() && first_.v.unmet().empty() && first_.pressure.lacks.empty() &&
         discretization().body.unmet().empty() && discretization().traction.unmet().empty();
}

AdmissiblePair PatchPairs::first_pair(Progress& progress) const {
  AdmissiblePair pair{{held_.discretization(), held_.solution(), held_.coupling(), progress},
                      {loaded_.discretization(), loaded_.solution().stress, loaded_.clearance()}};
  pair.v.relax(work_of_loads(held_.discretization(), progress), kStepsFromAverage, progress);
  minimize_stream_function(loaded_.discretization(), pair.v, loaded_.clearance(), pair.pressure, progress);
  return pair;
}

/// v₂ minimises ‖E ε(v − v₂) − δ‖_C, and then σ*₂ what is left of that.
AdmissiblePair PatchPairs::second_pair(Progress& progress) const {
  constexpr int steps = 40;
  const Mesh& mesh = *patch_.mesh;
  const StressValues<1> stress_at(discretization().spaces(), triangle_points());
  LawField<1> law(discretization().problem.material);
  const auto stress_of = [&](const AdmissibleDisplacement& v, int t) {
    const AffineMap map(mesh.corners(t));
    const Eigen::Matrix2d inverse = map.jacobian.inverse();
    const Quadratic<1> own = v.on<1>(t);
    StressAtPoints stress;
    for (int q = 0; q < TriangleRule::size; ++q)
      stress.col(q) = law(map(triangle_rule().points[q])).stiffness *
                      gradient<1>(inverse, own * quadratic_gradients()[q].transpose());
    return stress;
  };
  // σ* − σ_h without the stream function.
  const auto change = [&](int t) {
    const AffineMap map(mesh.corners(t));
    StressAtPoints stress;
    for (int q = 0; q < TriangleRule::size; ++q) stress.col(q) = stress_at(q, map, change_.col(t));
    return stress;
  };
  const auto delta = [&](int t) {
    const Eigen::Matrix2d inverse = AffineMap(mesh.corners(t)).jacobian.inverse();
    const Quadratic<1> stream_function = first_.stream_function_on(mesh, t);
    StressAtPoints stress = change(t);
    for (int q = 0; q < TriangleRule::size; ++q)
      stress.col(q) += curl(inverse, stream_function * quadratic_gradients()[q].transpose());
    return stress;
  };
  AdmissiblePair pair = first_;
  const Eigen::VectorXd work = work_of_stress(
      discretization(), [&](int t) -> StressAtPoints { return stress_of(first_.v, t) - delta(t); });
  pair.v.relax(work, steps, progress);
  // σ*₂ = σ* − δ + E ε(v − v₂) would be exact.
  minimize_stream_function(
      loaded_.discretization(), first_.v, loaded_.clearance(), pair.pressure, progress,
      [&](int t) -> StressAtPoints { return stress_of(first_.v, t) - stress_of(pair.v, t) - change(t); });
  return pair;
}

}  // namespace signorini
