#include "api/result/vtu.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "api/result/boundary_lines.hpp"
#include "fem/stress_invariants.hpp"

namespace signorini::api {
namespace {

/// One data array: how the head of the file describes it, and what writes its values.
struct DataArray {
  std::string attributes;
  std::uint64_t bytes = 0;
  std::function<void(PieceWriter& out)> write;
};

struct Section {
  std::string_view name;
  std::vector<DataArray> arrays;
};

/// VTK's vectors have three components; those that a value does not have are 0.
void put_vector(PieceWriter& out, const auto& value, int components) {
  for (int i = 0; i < components; ++i) out.put_binary(i < value.size() ? double{value[i]} : 0.);
}

DataArray doubles(std::string_view name, int components, std::uint64_t rows,
                  std::function<void(PieceWriter&)> write) {
  return {"type=\"Float64\" Name=\"" + std::string(name) + "\" NumberOfComponents=\"" +
              std::to_string(components) + "\"",
          rows * static_cast<std::uint64_t>(components) * sizeof(double), std::move(write)};
}

/// What is written, with its boundary.
struct Grid {
  const Solution& solution;
  const std::vector<BoundaryLine> lines;

  int triangles() const { return static_cast<int>(solution.mesh->triangles.size()); }
  std::uint64_t points() const { return 3 * solution.mesh->triangles.size() + 2 * lines.size(); }
  std::uint64_t cells() const { return solution.mesh->triangles.size() + lines.size(); }
};

/// An array with a row for each corner of each triangle, and behind them one for each end of each line:
/// `value(t, k)` at corner k of triangle t, which the line has from its triangle.
template <typename Value>
DataArray at_corners(std::string_view name, const Grid& grid, int components, const Value& value) {
  return doubles(name, components, grid.points(), [&grid, components, value](PieceWriter& out) {
    for (int t = 0; t < grid.triangles(); ++t)
      for (int k = 0; k < 3; ++k) put_vector(out, value(t, k), components);
    for (const BoundaryLine& line : grid.lines)
      for (const int k : line.corners) put_vector(out, value(line.triangle, k), components);
  });
}

/// The number, or the bits of none.
void put_or_nothing(PieceWriter& out, double number) {
  if (std::isnan(number))
    out.put_binary(std::bit_cast<std::uint64_t>(number));
  else
    out.put_binary(number);
}

/// An array with a row for each end of each line, and none of a triangle's corners.
DataArray at_ends(std::string_view name, const Grid& grid,
                  std::array<double, 2> BoundaryLine::*const values) {
  return doubles(name, 1, grid.points(), [&grid, values](PieceWriter& out) {
    for (int i = 0; i < 3 * grid.triangles(); ++i) put_or_nothing(out, std::nan(""));
    for (const BoundaryLine& line : grid.lines)
      for (const double value : line.*values) put_or_nothing(out, value);
  });
}

/// An array with a row for each triangle, which its lines have from it: `put(out, t)` writes that of triangle
/// t.
template <typename Put>
DataArray in_cells(std::string_view name, const Grid& grid, int components, const Put& put) {
  return doubles(name, components, grid.cells(), [&grid, put](PieceWriter& out) {
    for (int t = 0; t < grid.triangles(); ++t) put(out, t);
    for (const BoundaryLine& line : grid.lines) put(out, line.triangle);
  });
}

std::vector<DataArray> at_points(const Grid& grid) {
  const Solution& solution = grid.solution;
  const int d = solution.components, components = d == 1 ? 1 : 3;
  const Eigen::Index step = solution.displacement.rows() > d ? d : 0;
  const auto discontinuous = [&solution, d, step](int t, int k) {
    return solution.displacement.col(t).segment(k * step, d);
  };
  const auto continuous = [&solution](int t, int k) {
    return solution.displacement_at_points.col(solution.mesh->triangles[t][k]);
  };
  std::vector<DataArray> arrays{at_corners("displacement", grid, components, discontinuous),
                                at_corners("displacement_continuous", grid, components, continuous)};
  if (solution.contact.empty()) return arrays;
  arrays.push_back(at_ends("clearance", grid, &BoundaryLine::clearance));
  arrays.push_back(at_ends("pressure", grid, &BoundaryLine::pressure));
  return arrays;
}

/// (σ_x, σ_y, 0).
DataArray membrane_stress(const Grid& grid) {
  return in_cells("stress", grid, 3, [&solution = grid.solution](PieceWriter& out, int t) {
    put_vector(out, solution.stress_at_centroids.col(t), 3);
  });
}

/// The six components in VTK's order, named as ParaView shows them.
DataArray elastic_stress(const Grid& grid) {
  DataArray array = in_cells("stress", grid, 6, [&solution = grid.solution](PieceWriter& out, int t) {
    const auto stress = solution.stress_at_centroids.col(t);
    for (const double entry : {stress[0], stress[1], solution.out_of_plane_stress[t], stress[2], 0., 0.})
      out.put_binary(entry);
  });
  int number = 0;
  for (const char* component : {"XX", "YY", "ZZ", "XY", "YZ", "XZ"})
    array.attributes += " ComponentName" + std::to_string(number++) + "=\"" + component + "\"";
  return array;
}

DataArray equivalent_stress(const Grid& grid) {
  return in_cells("von_mises", grid, 1, [&solution = grid.solution](PieceWriter& out, int t) {
    out.put_binary(von_mises(solution.stress_at_centroids.col(t), solution.out_of_plane_stress[t]));
  });
}

/// The square of the error bound is its integral.
DataArray error_density(const Grid& grid) {
  return in_cells("error_density", grid, 1, [&solution = grid.solution](PieceWriter& out, int t) {
    const auto [a, b, c] = solution.mesh->corners(t);
    const Vector ab = b - a, ac = c - a;
    out.put_binary(solution.error_squares[t] / (std::abs(ab.x() * ac.y() - ab.y() * ac.x()) / 2));
  });
}

/// That of a line; −1 for a triangle.
DataArray part_numbers(const Grid& grid) {
  return {"type=\"Int32\" Name=\"part\"", grid.cells() * sizeof(std::int32_t), [&grid](PieceWriter& out) {
            for (int t = 0; t < grid.triangles(); ++t) out.put_binary(std::int32_t{-1});
            for (const BoundaryLine& line : grid.lines) out.put_binary(std::int32_t{line.part});
          }};
}

std::vector<DataArray> of_cells(const Grid& grid) {
  const Solution& solution = grid.solution;
  std::vector<DataArray> arrays{solution.components == 1 ? membrane_stress(grid) : elastic_stress(grid)};
  if (solution.components == 2) arrays.push_back(equivalent_stress(grid));
  if (solution.error_squares.size() == grid.triangles()) arrays.push_back(error_density(grid));
  arrays.push_back(part_numbers(grid));
  return arrays;
}

DataArray points(const Grid& grid) {
  return at_corners("Points", grid, 3, [&mesh = *grid.solution.mesh](int t, int k) {
    return mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])];
  });
}

/// Each triangle takes the next three points, and each line the next two.
std::vector<DataArray> cells(const Grid& grid) {
  static constexpr std::string_view vtk_triangle = "\5", vtk_line = "\3";
  const auto connectivity = [&grid](PieceWriter& out) {
    for (std::uint64_t point = 0; point < grid.points(); ++point) out.put_binary(point);
  };
  const auto offsets = [&grid](PieceWriter& out) {
    std::uint64_t offset = 0;
    for (std::uint64_t cell = 0; cell < grid.cells(); ++cell)
      out.put_binary(offset += cell < static_cast<std::uint64_t>(grid.triangles()) ? 3 : 2);
  };
  const auto types = [&grid](PieceWriter& out) {
    for (int t = 0; t < grid.triangles(); ++t) out.put(vtk_triangle);
    for (std::size_t line = 0; line < grid.lines.size(); ++line) out.put(vtk_line);
  };
  return {{"type=\"Int64\" Name=\"connectivity\"", grid.points() * sizeof(std::int64_t), connectivity},
          {"type=\"Int64\" Name=\"offsets\"", grid.cells() * sizeof(std::int64_t), offsets},
          {"type=\"UInt8\" Name=\"types\"", grid.cells(), types}};
}

std::vector<Section> sections(const Grid& grid) {
  return {{"PointData", at_points(grid)},
          {"CellData", of_cells(grid)},
          {"Points", {points(grid)}},
          {"Cells", cells(grid)}};
}

/// The data stand in the reverse order of their descriptions. VTK does not mind; meshio (Debian 12) replaces
/// the offsets by those of its base64 copy one after the other and takes the first description with the
/// offset that it looks for: in this order a new offset is never met before an old one of the same value.
std::vector<const DataArray*> order_of_data(const std::vector<Section>& sections) {
  std::vector<const DataArray*> order;
  for (const Section& section : sections)
    for (const DataArray& array : section.arrays) order.push_back(&array);
  std::ranges::reverse(order);
  return order;
}

std::uint64_t bytes_of(const Section& section) {
  std::uint64_t bytes = 0;
  for (const DataArray& array : section.arrays) bytes += sizeof(std::uint64_t) + array.bytes;
  return bytes;
}

/// Writes the descriptions; `end` is the number of bytes of the appended data.
void put_descriptions(PieceWriter& out, const std::vector<Section>& sections, std::uint64_t end) {
  for (const Section& section : sections) {
    out.put("      <" + std::string(section.name) + ">\n");
    for (const DataArray& array : section.arrays) {
      end -= sizeof(std::uint64_t) + array.bytes;
      out.put("        <DataArray " + array.attributes + " format=\"appended\" offset=\"" +
              std::to_string(end) + "\"/>\n");
    }
    out.put("      </" + std::string(section.name) + ">\n");
  }
}

void put_head(PieceWriter& out, const std::vector<Section>& sections, const Grid& grid) {
  out.put(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <UnstructuredGrid>\n");
  out.put("    <Piece NumberOfPoints=\"" + std::to_string(grid.points()) + "\" NumberOfCells=\"" +
          std::to_string(grid.cells()) + "\">\n");
  std::uint64_t bytes = 0;
  for (const Section& section : sections) bytes += bytes_of(section);
  put_descriptions(out, sections, bytes);
  out.put("    </Piece>\n  </UnstructuredGrid>\n");
}

/// The line break before the closing tag is asked for by meshio, which cuts the data there.
void put_data(PieceWriter& out, const std::vector<Section>& sections) {
  out.put("  <AppendedData encoding=\"raw\">\n_");
  for (const DataArray* array : order_of_data(sections)) {
    out.put_binary(array->bytes);
    array->write(out);
  }
  out.put("\n  </AppendedData>\n</VTKFile>\n");
}

}  // namespace

bool write_vtu(const Solution& solution, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    const Grid grid{solution, boundary_lines(solution)};
    const std::vector<Section> all = sections(grid);
    put_head(out, all, grid);
    put_data(out, all);
  });
}

}  // namespace signorini::api
