#include "api/vtu.hpp"

#include <algorithm>
#include <cstdint>

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

std::uint64_t triangles(const Solution& solution) {
  return solution.mesh.triangles.size();
}

DataArray doubles(std::string_view name, int components, std::uint64_t rows,
                  std::function<void(PieceWriter&)> write) {
  return {"type=\"Float64\" Name=\"" + std::string(name) + "\" NumberOfComponents=\"" +
              std::to_string(components) + "\"",
          rows * static_cast<std::uint64_t>(components) * sizeof(double), std::move(write)};
}

/// An array with a row for each corner of each triangle: `value(t, k)` at corner k of triangle t.
template <typename Value>
DataArray at_corners(std::string_view name, const Solution& solution, int components, const Value& value) {
  return doubles(name, components, 3 * triangles(solution), [&solution, components, value](PieceWriter& out) {
    for (int t = 0; t < static_cast<int>(triangles(solution)); ++t)
      for (int k = 0; k < 3; ++k) put_vector(out, value(t, k), components);
  });
}

std::vector<DataArray> displacements(const Solution& solution) {
  const int d = solution.components, components = d == 1 ? 1 : 3;
  const Eigen::Index step = solution.displacement.rows() > d ? d : 0;
  const auto discontinuous = [&solution, d, step](int t, int k) {
    return solution.displacement.col(t).segment(k * step, d);
  };
  const auto continuous = [&solution](int t, int k) {
    return solution.displacement_at_points.col(solution.mesh.triangles[t][k]);
  };
  return {at_corners("displacement", solution, components, discontinuous),
          at_corners("displacement_continuous", solution, components, continuous)};
}

/// (σ_x, σ_y, 0).
DataArray membrane_stress(const Solution& solution) {
  return doubles("stress", 3, triangles(solution), [&solution](PieceWriter& out) {
    for (const auto& stress : solution.stress_at_centroids.colwise()) put_vector(out, stress, 3);
  });
}

/// The six components in VTK's order, named as ParaView shows them.
DataArray elastic_stress(const Solution& solution) {
  DataArray array = doubles("stress", 6, triangles(solution), [&solution](PieceWriter& out) {
    for (int t = 0; t < static_cast<int>(triangles(solution)); ++t) {
      const auto stress = solution.stress_at_centroids.col(t);
      for (const double entry : {stress[0], stress[1], solution.out_of_plane_stress[t], stress[2], 0., 0.})
        out.put_binary(entry);
    }
  });
  int number = 0;
  for (const char* component : {"XX", "YY", "ZZ", "XY", "YZ", "XZ"})
    array.attributes += " ComponentName" + std::to_string(number++) + "=\"" + component + "\"";
  return array;
}

DataArray equivalent_stress(const Solution& solution) {
  return doubles("von_mises", 1, triangles(solution), [&solution](PieceWriter& out) {
    for (int t = 0; t < static_cast<int>(triangles(solution)); ++t)
      out.put_binary(von_mises(solution.stress_at_centroids.col(t), solution.out_of_plane_stress[t]));
  });
}

std::vector<DataArray> stresses(const Solution& solution) {
  if (solution.components == 1) return {membrane_stress(solution)};
  return {elastic_stress(solution), equivalent_stress(solution)};
}

DataArray points(const Solution& solution) {
  return at_corners("Points", solution, 3, [&mesh = solution.mesh](int t, int k) {
    return mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])];
  });
}

/// Each triangle takes the next three points.
std::vector<DataArray> cells(const Solution& solution) {
  static constexpr std::string_view vtk_triangle = "\5";
  const std::uint64_t count = triangles(solution);
  const auto connectivity = [count](PieceWriter& out) {
    for (std::uint64_t point = 0; point < 3 * count; ++point) out.put_binary(point);
  };
  const auto offsets = [count](PieceWriter& out) {
    for (std::uint64_t t = 0; t < count; ++t) out.put_binary(3 * (t + 1));
  };
  const auto types = [count](PieceWriter& out) {
    for (std::uint64_t t = 0; t < count; ++t) out.put(vtk_triangle);
  };
  return {{"type=\"Int64\" Name=\"connectivity\"", 3 * count * sizeof(std::int64_t), connectivity},
          {"type=\"Int64\" Name=\"offsets\"", count * sizeof(std::int64_t), offsets},
          {"type=\"UInt8\" Name=\"types\"", count, types}};
}

std::vector<Section> sections(const Solution& solution) {
  return {{"PointData", displacements(solution)},
          {"CellData", stresses(solution)},
          {"Points", {points(solution)}},
          {"Cells", cells(solution)}};
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

void put_head(PieceWriter& out, const std::vector<Section>& sections, std::uint64_t count) {
  out.put(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <UnstructuredGrid>\n");
  out.put("    <Piece NumberOfPoints=\"" + std::to_string(3 * count) + "\" NumberOfCells=\"" +
          std::to_string(count) + "\">\n");
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
    const std::vector<Section> all = sections(solution);
    put_head(out, all, triangles(solution));
    put_data(out, all);
  });
}

}  // namespace signorini::api
