#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "fem/clearance_space.hpp"
#include "memory_estimate.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/mesh_sizes.hpp"
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

/// The contact unknowns of a rectangle whose parts have so many edges.
std::int64_t contact_unknowns(const Problem& problem, const std::vector<MeshSizes::Part>& parts) {
  std::int64_t unknowns = 0;
  for (int side = 0; side < 4; ++side) {
    if (!condition_on<Contact>(problem, kRing[side])) continue;
    unknowns += parts[std::ranges::find(rectangle_parts(), kRing[side]) - rectangle_parts().begin()].edges;
    if (problem.scheme == Scheme::nonconforming) continue;
    ++unknowns;  // the nodes, less those that a fixed neighbour holds
    for (const int neighbour : {(side + 1) % 4, (side + 3) % 4})
      if (condition_on<Fixed>(problem, kRing[neighbour])) --unknowns;
  }
  return unknowns;
}

/// The edges whose middle becomes a node, or two where a curved boundary turns an elastic body's normal
/// there.
std::int64_t nodes_in_the_middle(const Problem& problem, const std::string& name,
                                 const MeshSizes::Part& part) {
  const auto* contact = condition_on<Contact>(problem, name);
  if (!contact) return 0;
  const bool turns = components(problem.material) == 2 && contact->direction.isZero(0);
  return part.edges + (turns ? part.chords : 0);
}

/// Those of the mesh before its refinements: of the mesh itself, or nearly.
std::int64_t contact_unknowns(const Problem& problem, const std::vector<std::string>& names,
                              const std::vector<MeshSizes::Part>& parts, const std::optional<Mesh>& mesh) {
  if (mesh) return make_clearance_space(problem, *mesh).unknowns;
  std::int64_t unknowns = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!condition_on<Contact>(problem, names[i])) continue;
    const bool by_nodes = problem.scheme == Scheme::conforming;
    unknowns += by_nodes ? nodes_in_the_middle(problem, names[i], parts[i]) + 1 : parts[i].edges;
  }
  return unknowns;
}

/// Of the mesh that the problem asks for. Small ones are made, as long as they do not have more triangles
/// together than `may_be_made`, which is lowered by them.
Counts count(const Problem& problem, const PredictedSizes& predicted, std::int64_t& may_be_made) {
  const std::vector<std::string> names = part_names(problem.domain);
  const bool is_rectangle = std::holds_alternative<Rectangle>(problem.domain);
  std::optional<Mesh> mesh;
  if (!is_rectangle && may_be_made > 0) mesh = make_small_mesh(problem.domain, problem.mesh);
  if (mesh) may_be_made -= static_cast<std::int64_t>(mesh->triangles.size());
  MeshSizes sizes = mesh ? sizes_of(*mesh) : predicted(problem.mesh);
  std::int64_t contact = is_rectangle ? 0 : contact_unknowns(problem, names, sizes.parts, mesh);
  for (int i = 0; i < problem.mesh.refine; ++i) {
    if (problem.scheme == Scheme::nonconforming) contact *= 2;
    for (std::size_t p = 0; problem.scheme == Scheme::conforming && p < names.size(); ++p)
      contact += nodes_in_the_middle(problem, names[p], sizes.parts[p]);
    sizes = refined(sizes, 1);
  }
  if (is_rectangle) contact = contact_unknowns(problem, sizes.parts);

  Counts counts{sizes.triangles, sizes.edges, sizes.points};
  for (std::size_t p = 0; p < names.size(); ++p)
    count_conditions(problem, names[p], sizes.parts[p].edges, counts);
  counts.contact_unknowns = contact;
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

Estimate estimate(const Problem& problem, const PredictedSizes& predicted, std::int64_t& may_be_made) {
  const Spaces& spaces = spaces_of(problem.scheme, components(problem.material));
  Counts counts = count(problem, predicted, may_be_made);
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

}  // namespace

Estimate estimate(const Problem& problem) {
  std::int64_t may_be_made = few_triangles;
  return estimate(problem, PredictedSizes(problem.domain), may_be_made);
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
  const PredictedSizes predicted(problem.domain);
  std::int64_t may_be_made = few_triangles;
  for (const Scheme scheme : study.schemes)
    for (const StudyMesh& mesh : study.meshes) {
      runs.push_back(estimate(run_of(problem, mesh, scheme), predicted, may_be_made));
      enough -= runs.back().unknowns.stress;
      if (enough < 0) return runs;
    }
  return runs;
}

}  // namespace signorini
