#include "certify/pressure/layers.hpp"

#include <algorithm>

namespace signorini {

std::vector<int> layers_around(const Mesh& mesh, const std::vector<int>& points, int most) {
  std::vector<int> layers(mesh.points.size(), most);
  for (const int point : points) layers[point] = 0;
  for (int layer = 1; layer < most; ++layer)
    for (const auto& corners : mesh.triangles)
      if (std::ranges::any_of(corners, [&](int point) { return layers[point] == layer - 1; }))
        for (const int point : corners) layers[point] = std::min(layers[point], layer);
  return layers;
}

}  // namespace signorini
