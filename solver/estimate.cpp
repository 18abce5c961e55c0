#include <algorithm>
#include <array>
#include <cmath>

#include "fem/clearance_space.hpp"
#include "memory_estimate.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/rectangle.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

/// The sizes of a mesh, and how many edges and clearance unknowns its conditions concern.
struct Counts {
  std::int64_t triangles = 0, edges = 0, points = 0;
  std::int64_t fixed_edges = 0, normal_edges = 0;  ///< on Γ_D; on rollers and contact
  std::int64_t contact_unknowns = 0;
};

void count_conditions(const Problem& problem, const std::string& part, std::int64_t edges, Counts& counts) {
  if (condition_on<Fixed>(problem, part)) counts.fixed_edges += edges;
  if (condition_on<Roller>(problem, part) || condition_on<Contact>(problem, part))
    counts.normal_edges += edges;
}

/// The sides of a rectangle in a ring, so that the neighbours of a side are the ones before and after it.
constexpr std::array kRing{"left", "bottom", "right", "top"};

/// Without making the mesh: a rectangle may have millions of triangles.
Counts count(const Problem& problem, const Rectangle& rectangle) {
  const Divisions squares = divisions(rectangle, problem.mesh);
  const std::int64_t refined = std::int64_t{1} << problem.mesh.refine;
  const std::int64_t n = std::int64_t{squares.x} * squares.y * refined * refined;
  const std::int64_t x = squares.x * refined, y = squares.y * refined;
  const bool crossed = problem.mesh.pattern == Pattern::crossed;
  Counts counts{(crossed ? 4 : 2) * n, (crossed ? 6 : 3) * n + x + y, (x + 1) * (y + 1) + (crossed ? n : 0)};
  for (int side = 0; side < 4; ++side) {
    const std::int64_t edges = side % 2 == 0 ? y : x;
    count_conditions(problem, kRing[side], edges, counts);
    if (!condition_on<Contact>(problem, kRing[side])) continue;
    counts.contact_unknowns += edges;
    if (problem.scheme == Scheme::nonconforming) continue;
    ++counts.contact_unknowns;  // the nodes, less those that a fixed neighbour holds
    for (const int neighbour : {(side + 1) % 4, (side + 3) % 4})
      if (condition_on<Fixed>(problem, kRing[neighbour])) --counts.contact_unknowns;
  }
  return counts;
}

template <typename OtherDomain>
Counts count(const Problem& problem, const OtherDomain&) {
  const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
  Counts counts{static_cast<std::int64_t>(mesh.triangles.size()),
                static_cast<std::int64_t>(mesh.edges.size()), static_cast<std::int64_t>(mesh.points.size())};
  for (const BoundaryPart& part : mesh.boundary)
    count_conditions(problem, part.name, static_cast<std::int64_t>(part.edges.size()), counts);
  counts.contact_unknowns = make_clearance_space(problem, mesh).unknowns;
  return counts;
}

/// The sizes that a mesh may grow to: the boundary as the root of the number of triangles. Every interior
/// edge has two of them, and by Euler there is about one point to two.
Counts grown(const Counts& start, const Adaptive& goal) {
  const auto triangles = std::max<std::int64_t>(start.triangles, goal.max_triangles);
  const double growth = static_cast<double>(triangles) / static_cast<double>(start.triangles);
  const auto boundary = [&](std::int64_t count) {
    return static_cast<std::int64_t>(std::sqrt(growth) * static_cast<double>(count));
  };
  const std::int64_t boundary_edges = boundary(2 * start.edges - 3 * start.triangles);
  return {triangles,
          (3 * triangles + boundary_edges) / 2,
          (triangles + boundary_edges) / 2 + 1,
          boundary(start.fixed_edges),
          boundary(start.normal_edges),
          boundary(start.contact_unknowns)};
}

}  // namespace

Estimate estimate(const Problem& problem) {
  const Spaces& spaces = spaces_of(problem.scheme, components(problem.material));
  Counts counts = std::visit([&](const auto& domain) { return count(problem, domain); }, problem.domain);
  if (problem.mesh.adaptive) counts = grown(counts, *problem.mesh.adaptive);
  const int inner = spaces.stresses() - 3 * spaces.traces_per_edge();
  Estimate estimate;
  estimate.triangles = counts.triangles;
  estimate.unknowns = {counts.edges * spaces.traces_per_edge() + counts.triangles * inner,
                       counts.triangles * spaces.displacements(), counts.contact_unknowns,
                       spaces.rotations() ? counts.points : 0};
  const std::int64_t held =
      (spaces.components * counts.fixed_edges + counts.normal_edges) * (spaces.order + 1);
  estimate.system =
      counts.edges * spaces.traces_per_edge() - held + estimate.unknowns.rotation + estimate.unknowns.contact;

  // Nested dissection fills a planar matrix of n unknowns with O(n log n) entries at O(n^1.5) operations;
  // the factors are fitted to measured solves.
  const double n = static_cast<double>(estimate.system),
               contact = static_cast<double>(counts.contact_unknowns);
  const double entries = n * std::log2(n + 2);
  const SolveSizes sizes{static_cast<double>(estimate.triangles), n, contact};
  estimate.memory_bytes = memory_of_solve(problem, spaces, sizes);
  estimate.paper_form_bytes = memory_of_paper_form(problem, spaces, sizes);
  estimate.solution_bytes = memory_of_solution(spaces, sizes.triangles);
  estimate.entry_bytes = memory_of_entry(contact);
  estimate.seconds = 1e-3 + 8e-8 * entries + 1.2e-9 * std::pow(n, 1.5) + 1e-10 * std::pow(contact, 3);
  return estimate;
}

Estimate for_solve(Estimate estimate, const Settings& settings, std::size_t entries) {
  if (std::holds_alternative<PaperUzawa>(settings.method))
    estimate.memory_bytes = std::max(estimate.memory_bytes, estimate.paper_form_bytes);
  // A sweep has a second solution, to which its entries refer.
  if (entries > 0)
    estimate.memory_bytes += estimate.solution_bytes + static_cast<double>(entries) * estimate.entry_bytes;
  return estimate;
}

double memory_with_study(const Estimate& problem, const std::vector<Estimate>& runs) {
  double bytes = problem.memory_bytes;
  for (const Estimate& run : runs) bytes = std::max(bytes, problem.solution_bytes + run.memory_bytes);
  return bytes;
}

std::vector<Estimate> estimate(const Problem& problem, const Study& study, std::int64_t enough) {
  std::vector<Estimate> runs;
  for (const Scheme scheme : study.schemes)
    for (const StudyMesh& mesh : study.meshes) {
      runs.push_back(estimate(run_of(problem, mesh, scheme)));
      enough -= runs.back().unknowns.stress;
      if (enough < 0) return runs;
    }
  return runs;
}

}  // namespace signorini
