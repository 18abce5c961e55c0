#include "certify/membrane/stream_function_nodes.hpp"

#include <algorithm>

#include "certify/pressure/layers.hpp"

namespace signorini {
namespace {

constexpr int kStreamFunctionLayers = 5;

/// Below this part of the largest stream function a value is that of a chain that changes elsewhere.
constexpr double kNothing = 1e-9;

std::vector<int> points_with_stream_function(const ContactPressure& pressure) {
  double largest = 0;
  for (const auto& [point, value] : pressure.stream_function_at_points)
    largest = std::max(largest, std::abs(value));
  std::vector<int> points;
  for (const auto& [point, value] : pressure.stream_function_at_points)
    if (std::abs(value) > kNothing * largest) points.push_back(point);
  return points;
}

}  // namespace

StreamFunctionNodes::StreamFunctionNodes(const Discretization& discrete)
    : StreamFunctionNodes(discrete, std::vector<int>(discrete.mesh.points.size(), 0)) {}

StreamFunctionNodes::StreamFunctionNodes(const Discretization& discrete, const ContactPressure& pressure)
    : StreamFunctionNodes(discrete, layers_around(discrete.mesh, points_with_stream_function(pressure),
                                                  kStreamFunctionLayers)) {}

StreamFunctionNodes::StreamFunctionNodes(const Discretization& discrete, const std::vector<int>& layers)
    : mesh_(discrete.mesh), numbers_(mesh_.points.size() + mesh_.edges.size(), -1) {
  for (int t = 0; t < discrete.triangles(); ++t) take(t, layers);
  leave_out_traction(discrete.problem);
  for (int& number : numbers_)
    if (number >= 0) number = size_++;
}

std::array<int, 6> StreamFunctionNodes::on(int t) const {
  std::array<int, 6> nodes;
  for (int k = 0; k < 3; ++k) {
    nodes[k] = at_point(mesh_.triangles[t][k]);
    nodes[3 + k] = at_middle(mesh_.triangle_edges[t][k]);
  }
  return nodes;
}

/// Marks the nodes with 0.
void StreamFunctionNodes::take(int t, const std::vector<int>& layers) {
  const auto is_inside = [&](int point) { return layers[point] < kStreamFunctionLayers; };
  if (std::ranges::none_of(mesh_.triangles[t], is_inside)) return;
  triangles_.push_back(t);
  for (const int point : mesh_.triangles[t])
    if (is_inside(point)) numbers_[point] = 0;
  for (const int edge : mesh_.triangle_edges[t])
    if (std::ranges::any_of(mesh_.edges[edge], is_inside)) numbers_[mesh_.points.size() + edge] = 0;
}

void StreamFunctionNodes::leave_out_traction(const Problem& problem) {
  for (const BoundaryPart& part : mesh_.boundary) {
    if (condition_on<Fixed>(problem, part.name) || condition_on<Contact>(problem, part.name)) continue;
    for (const int edge : part.edges) {
      numbers_[mesh_.points.size() + edge] = -1;
      for (const int point : mesh_.edges[edge]) numbers_[point] = -1;
    }
  }
}

}  // namespace signorini
