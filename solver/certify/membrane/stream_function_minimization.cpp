#include "certify/membrane/stream_function_minimization.hpp"

#include <algorithm>
#include <iterator>

#include <Eigen/LU>

#include "certify/membrane/stream_function_nodes.hpp"
#include "certify/pressure/admissible_minimum.hpp"
#include "mesh/parts.hpp"

namespace signorini {
namespace {

/// ½ Ψ·curvature Ψ + slope·Ψ is ‖curl Ψ − d‖²_C.
struct SquareOfCurl {
  SquareOfCurl(const Discretization& discrete, const StreamFunctionNodes& nodes, const StressField& d)
      : curvature(nodes.size(), nodes.size()), slope(Eigen::VectorXd::Zero(nodes.size())) {
    LawField<1> law(discrete.problem.material);
    std::vector<Eigen::Triplet<double>> entries;
    for (const int t : nodes.triangles()) {
      const AffineMap map(discrete.mesh.corners(t));
      const Eigen::Matrix2d to_gradients = map.jacobian.inverse().transpose();
      const std::array<int, 6> own = nodes.on(t);
      Eigen::Matrix<double, 6, 6> square = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> towards = Eigen::Matrix<double, 6, 1>::Zero();
      const StressAtPoints wanted = d ? d(t) : StressAtPoints::Zero();
      for (int q = 0; q < TriangleRule::size; ++q) {
        const Eigen::Matrix<double, 2, 6> rises = to_gradients * quadratic_gradients()[q];
        Eigen::Matrix<double, 2, 6> curls;
        curls << rises.row(1), -rises.row(0);
        const Eigen::Matrix<double, 6, 2> strains = 2 * triangle_rule().weights[q] * map.determinant *
                                                    curls.transpose() *
                                                    law(map(triangle_rule().points[q])).compliance;
        square += strains * curls;
        towards += strains * wanted.col(q);
      }
      for (int a = 0; a < 6; ++a) {
        if (own[a] < 0) continue;
        slope[own[a]] -= towards[a];
        for (int b = 0; b < 6; ++b)
          if (own[b] >= 0) entries.emplace_back(own[a], own[b], square(a, b));
      }
    }
    curvature.setFromTriplets(entries.begin(), entries.end());
  }

  Eigen::SparseMatrix<double> curvature;
  Eigen::VectorXd slope;
};

/// p* = p_h + ∂_t Ψ at both ends of edge i of the clearance space, with the domain on the left.
std::array<LinearForm, 2> changes_of(const Discretization& discrete, const StreamFunctionNodes& nodes,
                                     int i) {
  const int edge = discrete.clearance.edges[i].edge;
  const auto& [a, b] = discrete.mesh.edges[edge];
  const double sign = domain_on_the_left(discrete.mesh, edge)[0] == a ? 1 : -1,
               scale = sign / discrete.mesh.length(edge);
  const std::array own{nodes.at_point(a), nodes.at_point(b), nodes.at_middle(edge)};
  constexpr std::array<std::array<double, 3>, 2> slopes{{{-3, -1, 4}, {1, 3, -4}}};
  std::array<LinearForm, 2> changes;
  for (int end = 0; end < 2; ++end)
    for (int k = 0; k < 3; ++k)
      if (own[k] >= 0) changes[end].emplace_back(own[k], scale * slopes[end][k]);
  return changes;
}

}  // namespace

void minimize_stream_function(const Discretization& discrete, const AdmissibleDisplacement& v,
                              const Eigen::VectorXd& clearance, ContactPressure& pressure, Progress& progress,
                              const StressField& d) {
  if (!d && pressure.stream_function_at_points.empty()) return;
  const StreamFunctionNodes nodes =
      d ? StreamFunctionNodes(discrete) : StreamFunctionNodes(discrete, pressure);
  Eigen::VectorXd stream_function = Eigen::VectorXd::Zero(nodes.size());
  for (const auto& [point, value] : pressure.stream_function_at_points)
    if (nodes.at_point(point) >= 0) stream_function[nodes.at_point(point)] = value;
  for (const auto& [edge, value] : pressure.stream_function_at_middles)
    if (nodes.at_middle(edge) >= 0) stream_function[nodes.at_middle(edge)] = value;

  std::vector<MovingPressure> moving;
  for (int i = 0; i < static_cast<int>(discrete.clearance.edges.size()); ++i) {
    std::array<LinearForm, 2> changes = changes_of(discrete, nodes, i);
    if (changes[0].empty()) continue;
    std::ranges::move(moving_pressures(discrete, v, clearance, pressure, i, std::move(changes)),
                      std::back_inserter(moving));
  }
  SquareOfCurl square(discrete, nodes, d);
  square.slope += square.curvature * stream_function;
  const Eigen::VectorXd change =
      admissible_minimum(std::move(square.curvature), std::move(square.slope), moving, {}, progress);
  move(moving, change, pressure);
  stream_function += change;

  const Mesh& mesh = discrete.mesh;
  for (const int t : nodes.triangles())
    for (int k = 0; k < 3; ++k) {
      const int point = mesh.triangles[t][k], edge = mesh.triangle_edges[t][k];
      if (nodes.at_point(point) >= 0)
        pressure.stream_function_at_points[point] = stream_function[nodes.at_point(point)];
      if (nodes.at_middle(edge) >= 0)
        pressure.stream_function_at_middles[edge] = stream_function[nodes.at_middle(edge)];
    }
}

}  // namespace signorini
