#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "api/problem/gmsh.hpp"
#include "mesh/import.hpp"
#include "problem/field.hpp"

/// Whatever text stands for a mesh of Gmsh, it is refused with a fault, or its triangles and lines have
/// points.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace signorini;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const MeshData mesh = api::parse_gmsh(text);
    const auto points = static_cast<int>(mesh.points.size());
    const auto require_point = [points](int point) {
      if (point < 0 || point >= points) std::abort();
    };
    for (const auto& triangle : mesh.triangles)
      for (const int point : triangle) require_point(point);
    for (const auto& [name, edges] : mesh.boundary)
      for (const auto& edge : edges)
        for (const int point : edge) require_point(point);
    import_mesh(mesh);
  } catch (const InvalidProblem&) {
  }
  return 0;
}
