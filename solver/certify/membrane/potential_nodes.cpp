#include "certify/membrane/potential_nodes.hpp"

#include <algorithm>

#include "certify/pressure/layers.hpp"

namespace signorini {
namespace {

constexpr int kPotentialLayers = 5;

/// Below this part of the largest potential a value is that of a chain that changes elsewhere.
constexpr double kNothing = 1e-9;

std::vector<int> points_with_potential(const ContactPressure& pressure) {
  double largest = 0;
  for (const auto& [point, value] : pressure.potential_at_points)
    largest = std::max(largest, std::abs(value));
  std::vector<int> points;
  for (const auto& [point, value] : pressure.potential_at_points)
    if (std::abs(value) > kNothing * largest) points.push_back(point);
  return points;
}

}  // namespace

PotentialNodes::PotentialNodes(const Discretization& problem)
    : PotentialNodes(problem, std::vector<int>(problem.mesh.points.size(), 0)) {}

PotentialNodes::PotentialNodes(const Discretization& problem, const ContactPressure& pressure)
    : PotentialNodes(problem,
                     layers_around(problem.mesh, points_with_potential(pressure), kPotentialLayers)) {}

PotentialNodes::PotentialNodes(const Discretization& problem, const std::vector<int>& layers)
    : mesh_(problem.mesh), numbers_(mesh_.points.size() + mesh_.edges.size(), -1) {
  for (int t = 0; t < problem.triangles(); ++t) take(t, layers);
  leave_out_traction(problem.problem);
  for (int& number : numbers_)
    if (number >= 0) number = size_++;
}

std::array<int, 6> PotentialNodes::on(int t) const {
  std::array<int, 6> nodes;
  for (int k = 0; k < 3; ++k) {
    nodes[k] = at_point(mesh_.triangles[t][k]);
    nodes[3 + k] = at_middle(mesh_.triangle_edges[t][k]);
  }
  return nodes;
}

/// Marks the nodes with 0.
void PotentialNodes::take(int t, const std::vector<int>& layers) {
  const auto is_inside = [&](int point) { return layers[point] < kPotentialLayers; };
  if (std::ranges::none_of(mesh_.triangles[t], is_inside)) return;
  triangles_.push_back(t);
  for (const int point : mesh_.triangles[t])
    if (is_inside(point)) numbers_[point] = 0;
  for (const int edge : mesh_.triangle_edges[t])
    if (std::ranges::any_of(mesh_.edges[edge], is_inside)) numbers_[mesh_.points.size() + edge] = 0;
}

void PotentialNodes::leave_out_traction(const Problem& problem) {
  for (const BoundaryPart& part : mesh_.boundary) {
    if (condition_on<Fixed>(problem, part.name) || condition_on<Contact>(problem, part.name)) continue;
    for (const int edge : part.edges) {
      numbers_[mesh_.points.size() + edge] = -1;
      for (const int point : mesh_.edges[edge]) numbers_[point] = -1;
    }
  }
}

}  // namespace signorini
