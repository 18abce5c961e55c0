#include "api/picture/field_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>

#include "api/picture/colour_map.hpp"
#include "api/picture/foundation.hpp"
#include "api/picture/svg.hpp"
#include "fem/stress_invariants.hpp"

namespace signorini::api {
namespace {

/// What colours a triangle: one number, or one at each corner that is linear between.
struct Colouring {
  std::string name;
  bool is_linear;
  std::function<double(int triangle, int corner)> value;
};

double signed_principal(const Eigen::Vector3d& stress) {
  const auto [first, second] = principal_stresses(stress);
  return std::abs(first) >= std::abs(second) ? first : second;
}

Colouring by_displacement(const Solution& solution) {
  const Eigen::Index d = solution.components;
  const bool is_linear = solution.displacement.rows() > d;
  return {d == 1 ? "displacement" : "size of the displacement", is_linear,
          [&solution, d, is_linear](int t, int k) {
            const auto own = solution.displacement.col(t).segment(is_linear ? k * d : 0, d);
            return d == 1 ? own[0] : own.norm();
          }};
}

Colouring colouring(const Solution& solution, Picture::Field field) {
  if (field == Picture::Field::displacement) return by_displacement(solution);
  if (field == Picture::Field::error)
    return {"share of the error bound", false,
            [&](int t, int) { return std::sqrt(std::max(0., solution.error_squares[t])); }};
  if (field == Picture::Field::von_mises)
    return {"von Mises stress", false, [&](int t, int) {
              return von_mises(solution.stress_at_centroids.col(t), solution.out_of_plane_stress[t]);
            }};
  if (solution.components == 1)
    return {"size of the stress", false,
            [&](int t, int) { return solution.stress_at_centroids.col(t).norm(); }};
  return {"principal stress, the larger in size", false,
          [&](int t, int) { return signed_principal(solution.stress_at_centroids.col(t)); }};
}

ColourMap colours_of(const Colouring& by, int triangles) {
  if (triangles == 0) return {0, 1};
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int t = 0; t < triangles; ++t)
    for (int k = 0; k < (by.is_linear ? 3 : 1); ++k) {
      low = std::min(low, by.value(t, k));
      high = std::max(high, by.value(t, k));
    }
  return {low, high};
}

/// The points of the mesh, moved by so many times the displacement.
std::vector<Point> moved(const Solution& solution, std::optional<double> deformed) {
  std::vector<Point> points = solution.mesh->points;
  for (std::size_t p = 0; deformed && p < points.size(); ++p)
    points[p] += *deformed * solution.displacement_at_points.col(static_cast<Eigen::Index>(p));
  return points;
}

/// From the plane to pixels.
class View {
 public:
  static constexpr double most_width = 640, most_height = 520, margin = 30, top = 24;

  /// What lies in the box of these points is seen as large as fits.
  explicit View(const std::vector<Point>& points) {
    if (points.empty()) return;
    low_ = high_ = points.front();
    for (const Point& point : points) {
      low_ = low_.cwiseMin(point);
      high_ = high_.cwiseMax(point);
    }
    const Vector size = high_ - low_;
    scale_ = std::min((most_width - 2 * margin) / size.x(), (most_height - 2 * margin) / size.y());
  }

  double width() const { return scale_ * (high_.x() - low_.x()) + 2 * margin; }
  double height() const { return scale_ * (high_.y() - low_.y()) + 2 * margin + top; }
  double scale() const { return scale_; }
  Point operator()(const Point& point) const {
    return {margin + scale_ * (point.x() - low_.x()), margin + top + scale_ * (high_.y() - point.y())};
  }

 private:
  Point low_{0, 0}, high_{1, 1};
  double scale_ = 1;
};

/// A corner of a polygon with a linear function's value.
struct Corner {
  Point place;
  double value;
};
using Corners = std::vector<Corner>;

/// The part of a convex polygon where sign · (value − level) ≥ 0.
Corners part_beyond(const Corners& polygon, double level, double sign) {
  Corners part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Corner &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double da = sign * (a.value - level), db = sign * (b.value - level);
    if (da >= 0) part.push_back(a);
    if ((da < 0) != (db < 0) && da != db) {
      const double way = da / (da - db);
      part.push_back({a.place + way * (b.place - a.place), level});
    }
  }
  return part;
}

std::vector<Point> places_of(const Corners& polygon) {
  std::vector<Point> places;
  for (const Corner& corner : polygon) places.push_back(corner.place);
  return places;
}

Corners corners_of(const Mesh& mesh, const Colouring& by, const std::vector<Point>& places, int t) {
  Corners triangle;
  for (int k = 0; k < 3; ++k) triangle.push_back({places[mesh.triangles[t][k]], by.value(t, k)});
  return triangle;
}

/// The bands of colour that a triangle is in.
struct Bands {
  std::uint8_t first, last;
};

std::vector<Bands> bands_of(const Mesh& mesh, const Colouring& by, const ColourMap& colours) {
  std::vector<Bands> bands;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    const auto [least, most] = std::minmax({by.value(t, 0), by.value(t, 1), by.value(t, 2)});
    const auto first = static_cast<std::uint8_t>(colours.band(least));
    bands.push_back({first, by.is_linear ? static_cast<std::uint8_t>(colours.band(most)) : first});
  }
  return bands;
}

/// What is of one band is one element: the names of its pieces would be a third of the picture.
void fill_triangles(Svg& svg, const Mesh& mesh, const Colouring& by, const ColourMap& colours,
                    const std::vector<Point>& places) {
  const std::vector<Bands> bands = bands_of(mesh, by, colours);
  for (int band = 0; band < ColourMap::kBands; ++band) {
    bool has_begun = false;
    for (int t = 0; t < static_cast<int>(bands.size()); ++t) {
      const auto [first, last] = bands[t];
      if (band < first || band > last) continue;
      Corners part = corners_of(mesh, by, places, t);
      if (band > first) part = part_beyond(part, colours.start_of(band), 1);
      if (band < last) part = part_beyond(part, colours.start_of(band + 1), -1);
      if (part.size() < 3) continue;
      if (!has_begun) svg.begin_path("f c" + std::to_string(band));
      has_begun = true;
      svg.shape(places_of(part), true);
    }
    if (has_begun) svg.end_path();
  }
}

/// Lines that together follow each edge once, by their points: as long as there is a next edge, since a
/// line's first point takes as many digits as three more edges.
std::vector<std::vector<int>> lines_along(const Mesh& mesh) {
  std::vector<std::vector<std::size_t>> left(mesh.points.size());
  for (std::size_t edge = 0; edge < mesh.edges.size(); ++edge)
    for (const int point : mesh.edges[edge]) left[point].push_back(edge);
  std::vector<bool> is_drawn(mesh.edges.size());
  const auto step_from = [&](int point) -> std::optional<int> {
    while (!left[point].empty()) {
      const std::size_t edge = left[point].back();
      left[point].pop_back();
      if (is_drawn[edge]) continue;
      is_drawn[edge] = true;
      const auto [a, b] = mesh.edges[edge];
      return a == point ? b : a;
    }
    return std::nullopt;
  };
  std::vector<std::vector<int>> lines;
  for (int start = 0; start < static_cast<int>(left.size()); ++start)
    while (std::optional<int> next = step_from(start)) {
      std::vector<int>& line = lines.emplace_back(1, start);
      for (; next; next = step_from(*next)) line.push_back(*next);
    }
  return lines;
}

/// Where the edges are too close to each other to be told apart they would only darken the picture.
void draw_edges(Svg& svg, const Mesh& mesh, const View& view, const std::vector<Point>& places) {
  constexpr double closest = 4;
  if (mesh.triangles.empty()) return;
  const double pixels = view.scale() * std::sqrt(mesh.area() / static_cast<double>(mesh.triangles.size()));
  if (pixels >= closest) {
    svg.begin_path("mesh");
    for (const std::vector<int>& line : lines_along(mesh)) {
      std::vector<Point> shape;
      for (const int point : line) shape.push_back(places[point]);
      svg.shape(shape, false);
    }
    svg.end_path();
  }
  svg.begin_path("rim");
  for (const BoundaryPart& part : mesh.boundary)
    for (const int edge : part.edges)
      svg.shape(std::array{places[mesh.edges[edge][0]], places[mesh.edges[edge][1]]}, false);
  svg.end_path();
}

void draw_foundation(Svg& svg, const View& view, const std::vector<std::vector<Point>>& lines) {
  if (lines.empty()) return;
  svg.begin_path("foundation");
  for (const std::vector<Point>& line : lines) {
    std::vector<Point> places;
    for (const Point& point : line) places.push_back(view(point));
    svg.shape(places, false);
  }
  svg.end_path();
}

void draw_scale(Svg& svg, const ColourMap& colours, const std::string& name, double left) {
  constexpr double top = View::margin + View::top, high = 8, wide = 16;
  constexpr int bands = ColourMap::kBands;
  svg.text({View::margin, 20}, name, "name");
  for (int band = 0; band < bands; ++band)
    svg.rectangle({left, top + high * (bands - 1 - band)}, {wide, high}, "f c" + std::to_string(band));
  for (int tick = 0; tick <= 4; ++tick)
    svg.text({left + wide + 5, top + high * bands * (1 - tick / 4.) + 4},
             in_short(colours.start_of(bands * tick / 4)), "number");
}

std::string styles(const ColourMap& colours) {
  std::string all =
      ".number{font-size:11px}.f{stroke-width:.5;stroke-linejoin:round}.mesh{fill:none;stroke:#000;"
      "stroke-opacity:.2;stroke-width:.6}.rim{fill:none;stroke:#222;stroke-width:1.4;stroke-linecap:round}"
      ".foundation{fill:none;stroke:#000;stroke-width:1.6;stroke-dasharray:7 4}";
  for (int band = 0; band < ColourMap::kBands; ++band) {
    const std::string own = colours.colour(band);
    all.append(".c")
        .append(std::to_string(band))
        .append("{fill:")
        .append(own)
        .append(";stroke:")
        .append(own)
        .append("}");
  }
  return all;
}

}  // namespace

void draw_field(const Solution& solution, const Picture& picture, PieceWriter& out) {
  constexpr double of_scale = 90, least_width = 260, least_height = 360;
  const Colouring by = colouring(solution, picture.field);
  const ColourMap colours = colours_of(by, static_cast<int>(solution.mesh->triangles.size()));
  const std::vector<Point> points = moved(solution, picture.deformed);
  std::vector<std::vector<Point>> lines;
  if (solution.components == 2) lines = foundation(solution, picture.contacts, picture.deformed.value_or(1));
  std::vector<Point> seen = points;
  for (const std::vector<Point>& line : lines) seen.insert(seen.end(), line.begin(), line.end());
  const View view(seen);
  std::vector<Point> places;
  for (const Point& point : points) places.push_back(view(point));
  const double width = std::max(least_width, view.width());
  Svg svg(out, width + of_scale, std::max(least_height, view.height()), by.name, styles(colours));
  fill_triangles(svg, *solution.mesh, by, colours, places);
  draw_edges(svg, *solution.mesh, view, places);
  draw_foundation(svg, view, lines);
  draw_scale(svg, colours, by.name, width + 6);
  svg.end();
}

}  // namespace signorini::api
