#include "api/names.hpp"
#include "api/result/result_members.hpp"
#include "fem/stress_invariants.hpp"

namespace signorini::api {
namespace {

/// The names of the spaces of stress and displacement.
struct Spaces {
  const char* stress;
  const char* displacement;
};

Spaces spaces(Scheme scheme) {
  return scheme == Scheme::conforming ? Spaces{"RT1", "P1"} : Spaces{"RT0", "P0"};
}

/// The extents of an array of values with so many components: a value of one component is a number.
Shape with_components(Shape places, int components) {
  if (components > 1) places.push_back(static_cast<std::size_t>(components));
  return places;
}

std::span<const double> all_of(const Eigen::MatrixXd& matrix) {
  return {matrix.data(), static_cast<std::size_t>(matrix.size())};
}

std::size_t columns(const Eigen::MatrixXd& matrix) {
  return static_cast<std::size_t>(matrix.cols());
}

void write_points(DocumentWriter& out, const std::vector<Point>& points) {
  out.rows({points.size(), 2}, [&](std::size_t i) { return points[i]; });
}

void write_triangles(DocumentWriter& out, const std::vector<std::array<int, 3>>& triangles) {
  out.rows({triangles.size(), 3}, [&](std::size_t t) { return triangles[t]; });
}

void write_shares(DocumentWriter& out, const Eigen::VectorXd& squares) {
  out.rows({static_cast<std::size_t>(squares.size())}, [&](std::size_t t) { return squares[t]; });
}

void write_column(DocumentWriter& out, const std::vector<double>& column) {
  out.numbers({column.size()}, std::span(column));
}

}  // namespace

void write_mesh(DocumentWriter& out, const Mesh& mesh) {
  out.begin_object();
  write_points(out.key("points"), mesh.points);
  write_triangles(out.key("triangles"), mesh.triangles);
  out.key("boundary").begin_object();
  for (const BoundaryPart& part : mesh.boundary) {
    out.key(part.name).rows({part.edges.size(), 2}, [&](std::size_t i) {
      return mesh.edges[static_cast<std::size_t>(part.edges[i])];
    });
  }
  out.end_object().end_object();
}

void write_level_fields(DocumentWriter& out, const std::vector<LevelFields>& levels) {
  out.begin_array();
  for (const LevelFields& level : levels) {
    const auto& [number, points, triangles, displacement_at_points, error_squares] = level;
    out.begin_object().member("level", number);
    write_points(out.key("points"), points);
    write_triangles(out.key("triangles"), triangles);
    const int d = static_cast<int>(displacement_at_points.rows());
    out.key("displacement_at_points")
        .numbers(with_components({points.size()}, d), all_of(displacement_at_points));
    write_shares(out.key("error_squares"), error_squares);
    out.end_object();
  }
  out.end_array();
}

void write_displacement(DocumentWriter& out, const Solution& solution) {
  const Eigen::MatrixXd& values = solution.displacement;
  const int d = solution.components;
  const bool at_corners = values.rows() > d;
  const Shape places = at_corners ? Shape{columns(values), 3} : Shape{columns(values)};
  out.begin_object().member("space", spaces(solution.scheme).displacement);
  out.key("values").numbers(with_components(places, d), all_of(values));
  const Eigen::MatrixXd& at_points = solution.displacement_at_points;
  out.key("at_points").numbers(with_components({columns(at_points)}, d), all_of(at_points));
  out.end_object();
}

void write_stress(DocumentWriter& out, const Solution& solution) {
  const Eigen::MatrixXd& stress = solution.stress_at_centroids;
  out.begin_object().member("space", spaces(solution.scheme).stress);
  out.key("at_centroids");
  out.numbers({columns(stress), static_cast<std::size_t>(stress.rows())}, all_of(stress)).end_object();
}

void write_principal(DocumentWriter& out, const Solution& solution) {
  const Eigen::MatrixXd& stress = solution.stress_at_centroids;
  out.rows({columns(stress), 2}, [&](std::size_t t) { return principal_stresses(stress.col(t)); });
}

void write_von_mises(DocumentWriter& out, const Solution& solution) {
  const Eigen::MatrixXd& stress = solution.stress_at_centroids;
  out.rows({columns(stress)},
           [&](std::size_t t) { return von_mises(stress.col(t), solution.out_of_plane_stress[t]); });
}

void write_error_squares(DocumentWriter& out, const Solution& solution) {
  write_shares(out, solution.error_squares);
}

void write_contact(DocumentWriter& out, const std::vector<ContactPart>& parts) {
  out.begin_object();
  for (const ContactPart& part : parts) {
    out.key(part.name).begin_object();
    write_points(out.key("points"), part.points);
    write_column(out.key("clearance"), part.clearance);
    write_column(out.key("pressure"), part.pressure);
    write_column(out.key("gap"), part.gap);
    out.key("open").begin_array();
    for (const bool open : part.open) out.value(open);
    out.end_array().end_object();
  }
  out.end_object();
}

}  // namespace signorini::api
