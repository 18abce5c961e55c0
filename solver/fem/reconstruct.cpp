#include "fem/reconstruct.hpp"

namespace signorini {
namespace {

/// A column or a row a component, without memory of its own: there is one for each triangle.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2, 2>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2, 1>;

/// ∇u at the centroid of a triangle, a row a component: C σ, and for elasticity γ [0 1; −1 0] besides.
SmallMatrix gradient(const Compliance& compliance, const Solution& solution, int t) {
  const auto stress = solution.stress_at_centroids.col(t);
  if (solution.components == 1) return compliance.lazyProduct(stress).transpose();
  const Eigen::Vector4d strain = compliance * Eigen::Vector4d(stress[0], stress[2], stress[2], stress[1]);
  const auto& [a, b, c] = solution.mesh->triangles[t];
  const double rotation = (solution.rotation[a] + solution.rotation[b] + solution.rotation[c]) / 3;
  Eigen::Matrix2d gradient;
  gradient << strain[0], strain[1] + rotation, strain[2] - rotation, strain[3];
  return gradient;
}

void fix_points(const Problem& problem, const Mesh& mesh, Eigen::MatrixXd& values) {
  for (const BoundaryPart& part : mesh.boundary)
    if (const auto* fixed = condition_on<Fixed>(problem, part.name))
      for (const int edge : part.edges)
        for (int end = 0; end < 2; ++end) {
          const auto [x, normal] = mesh.on_boundary(edge, end);
          for (int c = 0; c < values.rows(); ++c)
            values(c, mesh.edges[edge][end]) = fixed->value(c, x, normal);
        }
}

}  // namespace

Eigen::MatrixXd stress_at_centroids(const Mesh& mesh, const Spaces& spaces, const Eigen::MatrixXd& stress) {
  const LocalVectors reference = spaces.row.reference_values(Point(1. / 3, 1. / 3));
  Eigen::MatrixXd values(spaces.components == 1 ? 2 : 3, mesh.triangles.size());
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const AffineMap map(mesh.corners(t));
    const auto rows = stress.col(t).reshaped(spaces.components, spaces.row.size());
    // Column c: row c of the stress.
    const SmallMatrix on_reference = reference.lazyProduct(rows.transpose());
    const SmallMatrix tensor = map.jacobian.lazyProduct(on_reference) / map.determinant;
    if (spaces.components == 1)
      values.col(t) = tensor.col(0);
    else
      values.col(t) << tensor(0, 0), tensor(1, 1), 0.5 * (tensor(1, 0) + tensor(0, 1));
  }
  return values;
}

Eigen::VectorXd out_of_plane_stress(const Material& material, const Mesh& mesh,
                                    const Eigen::MatrixXd& stress_at_centroids) {
  if (components(material) == 1) return {};
  Eigen::VectorXd values = Eigen::VectorXd::Zero(stress_at_centroids.cols());
  const auto* isotropic = std::get_if<YoungPoisson>(&material);
  if (!isotropic || isotropic->plane == Plane::stress) return values;
  for (int t = 0; t < static_cast<int>(values.size()); ++t) {
    const auto corners = mesh.corners(t);
    const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
    values[t] = isotropic->poisson(centroid) * (stress_at_centroids(0, t) + stress_at_centroids(1, t));
  }
  return values;
}

Eigen::MatrixXd displacement_at_points(const Problem& problem, const Solution& solution) {
  const Mesh& mesh = *solution.mesh;
  const int d = solution.components;
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(d, mesh.points.size());
  Eigen::VectorXd triangles_at = Eigen::VectorXd::Zero(mesh.points.size());
  const bool varies = !is_constant(problem.material);
  Compliance compliance;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto corners = mesh.corners(t);
    const Point centroid = (corners[0] + corners[1] + corners[2]) / 3;
    if (varies || t == 0) compliance = compliance_at(problem.material, centroid);
    const SmallMatrix slope = gradient(compliance, solution, t);
    const SmallVector mean =
        solution.displacement.col(t).reshaped(d, solution.displacement.rows() / d).rowwise().mean();
    for (int k = 0; k < 3; ++k) {
      values.col(mesh.triangles[t][k]) += mean + slope.lazyProduct(corners[k] - centroid);
      ++triangles_at[mesh.triangles[t][k]];
    }
  }
  for (Eigen::Index p = 0; p < values.cols(); ++p) values.col(p) /= std::max(1., triangles_at[p]);
  fix_points(problem, mesh, values);
  return values;
}

}  // namespace signorini
