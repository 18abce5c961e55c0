#include "certify/elasticity/edge_tractions.hpp"

#include <cmath>

#include "certify/local_fields.hpp"
#include "fem/couple.hpp"
#include "fem/lagrange.hpp"
#include "mesh/parts.hpp"
#include "mesh/triangles_at_points.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// Column t: ∫ φ_z (σ_xy − σ_yx) over triangle t for its three corners z.
Eigen::Matrix3Xd asymmetry(const Discretization& discrete, const Eigen::MatrixXd& stress,
                           Progress& progress) {
  const StressValues<2> values(discrete.spaces(), triangle_points());
  Eigen::Matrix3Xd moments = Eigen::Matrix3Xd::Zero(3, discrete.triangles());
  in_parts(discrete.triangles(), progress, [&](Part part, Progress& own) {
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      const AffineMap map(discrete.mesh.corners(t));
      for (int q = 0; q < TriangleRule::size; ++q) {
        const Tensor<2> sigma = values(q, map, stress.col(t));
        moments.col(t) += triangle_rule().weights[q] * map.determinant * (sigma[1] - sigma[2]) *
                          triangle_basis(1, triangle_rule().points[q]);
      }
    }
  });
  return moments;
}

int corner_number(const Mesh& mesh, int t, int point) {
  const auto& corners = mesh.triangles[t];
  return corners[0] == point ? 0 : (corners[1] == point ? 1 : 2);
}

/// The edges of a triangle at one of its points that a way around the point, counter-clockwise, crosses first
/// and last.
int entrance(const Mesh& mesh, int t, int point) {
  return mesh.triangle_edges[t][(corner_number(mesh, t, point) + 2) % 3];
}
int exit(const Mesh& mesh, int t, int point) {
  return mesh.triangle_edges[t][(corner_number(mesh, t, point) + 1) % 3];
}

int other_side(const Mesh& mesh, int edge, int t) {
  const auto& [first, second] = mesh.edge_triangles[edge];
  return first == t ? second : first;
}

}  // namespace

EdgeTractions::EdgeTractions(const Discretization& discrete, const Eigen::MatrixXd& stress,
                             const ContactPressure& pressure, Progress& progress)
    : discrete_(discrete), given_(discrete.traction), tractions_(discrete.mesh.edges.size()) {
  take_from(stress, progress);
  change_pressure(pressure);
  Eigen::Matrix3Xd moments = asymmetry(discrete, stress, progress);
  if (discrete.spaces().leaves_couples()) take_couples(moments);
  balance(moments, progress);
}

Eigen::Matrix<double, 2, 3> EdgeTractions::on(int t, int e) const {
  const int edge = discrete_.mesh.triangle_edges[t][e];
  Eigen::Matrix2d ends = tractions_[edge];
  if (discrete_.mesh.edge_triangles[edge][0] != t) ends = -ends.rowwise().reverse().eval();
  Eigen::Matrix<double, 2, 3> all = linear_along_edge(ends);
  if (!given_.acts_on(edge)) return all;
  for (int c = 0; c < 2; ++c) {
    // What t has beyond its linear part is the same from either end.
    const auto own = [&](double s) { return given_(edge, c, s); };
    all.row(c) += (projection_at_nodes(2, own) - projection_at_nodes(1, own)).transpose();
  }
  return all;
}

void EdgeTractions::take_from(const Eigen::MatrixXd& stress, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  const int order = discrete_.spaces().order;
  in_parts(static_cast<int>(mesh.edges.size()), progress, [&](Part part, Progress& own) {
    for (int edge = part.begin; edge < part.end; ++edge) {
      own.check_in(edge);
      const int t = mesh.edge_triangles[edge][0], e = mesh.local_edge(t, edge);
      for (int c = 0; c < 2; ++c) {
        LocalVector fluxes(order + 1);
        for (int j = 0; j <= order; ++j) fluxes[j] = stress((e * (order + 1) + j) * 2 + c, t);
        const LocalVector density = project_onto_edge(order, fluxes) / mesh.length(edge);
        at(edge).row(c) << density[0], density[order];
      }
    }
  });
}

/// The couples as the rotation took them, and the traction's linear part, whose couple is among them.
void EdgeTractions::take_couples(Eigen::Matrix3Xd& moments) {
  const Mesh& mesh = discrete_.mesh;
  for (int t = 0; t < discrete_.triangles(); ++t) moments.col(t).array() -= discrete_.couples[t] / 3;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (!given_.acts_on(edge)) continue;
    const int t = mesh.edge_triangles[edge][0], e = mesh.local_edge(t, edge);
    const int from = (e + 1) % 3, to = (e + 2) % 3;
    const bool forward = mesh.triangles[t][from] == mesh.edges[edge][0];
    for (int c = 0; c < 2; ++c) {
      const LocalVector linear =
          project_onto_edge(1, edge_moments(1, [&](double s) { return given_(edge, c, s); }));
      at(edge).row(c) << linear[forward ? 0 : 1], linear[forward ? 1 : 0];
    }
    const double couple = couple_of_traction(given_, mesh, edge);
    for (const int z : {from, to}) moments(z, t) -= couple / 2;
  }
}

/// The flux of the stream function around each point balances the moments of every triangle there.
void EdgeTractions::balance(const Eigen::Matrix3Xd& moments, Progress& progress) {
  const TrianglesAtPoints triangles(discrete_.mesh);
  for (int point = 0; point < static_cast<int>(discrete_.mesh.points.size()); ++point) {
    progress.check_in(point);
    turn_around(point, triangles[point], moments);
  }
}

void EdgeTractions::turn_around(int point, std::span<const int> triangles, const Eigen::Matrix3Xd& moments) {
  if (triangles.empty()) return;
  const Mesh& mesh = discrete_.mesh;
  int start = triangles[0];
  for (const int t : triangles)
    if (other_side(mesh, entrance(mesh, t, point), t) < 0) start = t;

  // The flux out of each triangle through its exit is the one that came in, and its own.
  std::vector<int> edges, from;
  std::vector<double> fluxes;
  double flux = 0;
  for (int t = start; t >= 0 && edges.size() < triangles.size();
       t = other_side(mesh, exit(mesh, t, point), t)) {
    flux += moments(corner_number(mesh, t, point), t);
    edges.push_back(exit(mesh, t, point));
    from.push_back(t);
    fluxes.push_back(flux);
  }
  if (edges.size() < triangles.size())
    unmet_.push_back("the body touches itself in the point " + to_string(mesh.points[point]));
  const bool inside = other_side(mesh, edges.back(), from.back()) >= 0;
  double mean = 0;
  if (inside)
    for (const double own : fluxes) mean += own / static_cast<double>(fluxes.size());
  else
    fluxes.back() = 0;  // all that is left is rounding

  for (std::size_t i = 0; i < edges.size(); ++i) {
    const int first = mesh.edge_triangles[edges[i]][0];
    const double out = (from[i] == first ? 1 : -1) * (fluxes[i] - mean);
    const int e = mesh.local_edge(first, edges[i]);
    const auto corners = mesh.corners(first);
    const Vector edge = corners[(e + 2) % 3] - corners[(e + 1) % 3];
    // The bubble is 6 s (1 − s) / |e| n with n |e| = (edge_y, −edge_x); its derivative is ±6 / |e|² at the
    // ends.
    const double square = edge.squaredNorm();
    const Vector change = 6 * out / square * Vector(edge.y(), -edge.x()) / std::sqrt(square);
    at(edges[i]).col(0) += change;
    at(edges[i]).col(1) -= change;
  }
}

Eigen::Matrix2d EdgeTractions::of_airy(const ContactPressure::Airy& a, const ContactPressure::Airy& b,
                                       const Vector& way) {
  const double length = way.norm();
  const Vector t = way / length, n(t.y(), -t.x());
  const double rise = (b.value - a.value) / length, slope_a = a.gradient.dot(t), slope_b = b.gradient.dot(t);
  const Vector along = -(b.gradient - a.gradient).dot(n) / length * t;
  Eigen::Matrix2d ends;
  ends << (6 * rise - 4 * slope_a - 2 * slope_b) / length * n + along,
      (-6 * rise + 2 * slope_a + 4 * slope_b) / length * n + along;
  return ends;
}

Eigen::Matrix2d EdgeTractions::of_turn(const Vector& way) {
  return way / way.squaredNorm() * Eigen::RowVector2d(1, -1);
}

void EdgeTractions::add(const Eigen::Matrix3Xd& airy, const Eigen::VectorXd& turns) {
  const Mesh& mesh = discrete_.mesh;
  const auto at_point = [&](int point) {
    return ContactPressure::Airy{airy(0, point), airy.col(point).tail<2>()};
  };
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    const auto [from, to] = domain_on_the_left(mesh, edge);
    const Vector way = mesh.points[to] - mesh.points[from];
    at(edge) +=
        of_airy(at_point(from), at_point(to), way) + (from < to ? 1 : -1) * turns[edge] * of_turn(way);
  }
}

/// On Γ_C the traction changes by −(p* − p_h) d, and by what lacks.
void EdgeTractions::change_pressure(const ContactPressure& pressure) {
  const Mesh& mesh = discrete_.mesh;
  std::vector<bool> on_contact(mesh.edges.size(), false);
  for (int i = 0; i < static_cast<int>(discrete_.clearance.edges.size()); ++i) {
    const int edge = discrete_.clearance.edges[i].edge;
    on_contact[edge] = true;
    const auto [first, second] = pressure.changes[i];
    const bool forward = domain_on_the_left(mesh, edge)[0] == mesh.edges[edge][0];
    const Vector d = discrete_.clearance.edges[i].direction;
    at(edge).col(0) -= (forward ? first : second) * d;
    at(edge).col(1) -= (forward ? second : first) * d;
  }
  for (const ContactPressure::Lack& lack : pressure.lacks) at(lack.edge) += lack.traction;
  if (pressure.airy_at_points.empty()) return;
  const auto airy = [&](int point) {
    const auto found = pressure.airy_at_points.find(point);
    return found == pressure.airy_at_points.end() ? ContactPressure::Airy{} : found->second;
  };
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    const auto& [p, q] = mesh.edges[edge];
    if (on_contact[edge] || !(pressure.airy_at_points.contains(p) || pressure.airy_at_points.contains(q)))
      continue;
    const auto [from, to] = domain_on_the_left(mesh, edge);
    at(edge) += of_airy(airy(from), airy(to), mesh.points[to] - mesh.points[from]);
  }
}

}  // namespace signorini
