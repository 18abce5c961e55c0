#include "estimation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "fem/clearance_space.hpp"
#include "fem/stability.hpp"
#include "mesh/rectangle.hpp"
#include "mesh/refine.hpp"
#include "mesh/rings.hpp"
#include "run/openings.hpp"

namespace signorini {
namespace {

/// The same with edges so many times as long.
MeshRequest coarser(MeshRequest request, double times) {
  std::get<LargestEdge>(request.fineness).length *= times;
  for (LocalSize& local : request.sizes) local.size *= times;
  return request;
}

/// By how much longer edges a mesh has no more triangles than `most`: twice, four times and so on.
double longer_for(std::int64_t triangles, std::int64_t most) {
  double times = 1;
  while (static_cast<double>(triangles) > static_cast<double>(most) * times * times) times *= 2;
  return times;
}

/// By how many a part of a given mesh has more nodes than edges, at most: by one a chain, and where it turns
/// by one more, if two edges do not share theirs there. At a point of more edges bodies meet, each with its
/// own.
int nodes_beyond_edges(const std::vector<Point>& points, const std::vector<std::array<int, 2>>& edges,
                       bool turns) {
  std::vector<std::pair<int, Vector>> ways;
  for (const auto& [a, b] : edges) {
    const int known = static_cast<int>(points.size());
    if (std::min(a, b) < 0 || std::max(a, b) >= known) continue;  // which the import says
    const Vector way = points[b] - points[a];
    ways.emplace_back(a, way);
    ways.emplace_back(b, way);
  }
  std::ranges::sort(ways, {}, &std::pair<int, Vector>::first);
  std::ptrdiff_t nodes = 0;
  for (auto own = ways.begin(); own != ways.end();) {
    const auto next =
        std::ranges::find_if(own, ways.end(), [&](const auto& way) { return way.first != own->first; });
    const std::ptrdiff_t count = next - own;
    const auto is_straight = [](const Vector& one, const Vector& other) {
      return std::abs(one.x() * other.y() - one.y() * other.x()) <= 1e-12 * one.norm() * other.norm();
    };
    const bool is_one = count == 1 || (count == 2 && (!turns || is_straight(own->second, own[1].second)));
    nodes += is_one ? 1 : turns ? count : (count + 1) / 2;
    own = next;
  }
  return static_cast<int>(nodes - static_cast<std::ptrdiff_t>(edges.size()));
}

/// Of certifying with a law that varies, as measured: where it is smooth most triangles are one piece or few.
double seconds_of_law(const Material& material, const Spaces& spaces, double triangles) {
  if (is_constant(material)) return 0;
  const double of_membrane = spaces.order == 0 ? 3e-5 : 1e-4, of_body = spaces.order == 0 ? 2.2e-4 : 4e-4;
  return (spaces.components == 1 ? of_membrane : of_body) * triangles;
}

/// Of certifying triangles whose shapes no others have, so that nothing of them is shared, as measured. Where
/// the law varies that is in seconds_of_law().
double seconds_of_shapes(const Material& material, const Spaces& spaces, double shapes) {
  if (!is_constant(material)) return 0;
  const double of_membrane = spaces.order == 0 ? 6e-6 : 1.3e-5, of_body = spaces.order == 0 ? 5e-5 : 6.5e-5;
  return (spaces.components == 1 ? of_membrane : of_body) * shapes;
}

/// Of enclosing a quantity, as measured: its dual problem, its certificate and the sums over the mesh, which
/// ask for the law three times as often as a certificate. The cells of a load that jumps share a budget.
double seconds_of(const Quantity& quantity, const Material& material, const Spaces& spaces,
                  double triangles) {
  const double of_dual = spaces.components == 1 ? 3e-6 : spaces.order == 0 ? 1.1e-5 : 1.4e-5;
  const bool varies = !std::ranges::all_of(quantity.density.fields(), &Field::is_constant);
  const double of_cells = quantity.disc || quantity.outline ? 0.7 * std::pow(triangles / 512, 0.3) : 0;
  return (of_dual + (varies ? 8e-6 : 0)) * triangles + of_cells +
         3 * seconds_of_law(material, spaces, triangles);
}

/// One of the quantities that are openings, with a weight that varies if there is one: then the body takes
/// more. Null if there is none.
const Quantity* heaviest_opening(const std::vector<Quantity>& quantities) {
  const Quantity* heaviest = nullptr;
  for (const Quantity& quantity : quantities) {
    const bool varies = std::ranges::any_of(
        quantity.openings, [](const auto& opening) { return !opening.second.is_constant(); });
    if (!quantity.openings.empty() && (heaviest == nullptr || varies)) heaviest = &quantity;
  }
  return heaviest;
}

}  // namespace

double seconds_of_quantities(const Problem& problem, double triangles) {
  const Spaces& spaces = spaces_of(problem.scheme, components(problem.material));
  double sum = 0;
  for (const Quantity& quantity : problem.quantities)
    sum += seconds_of(quantity, problem.material, spaces, triangles);
  return sum;
}

Estimation::Estimation(const Problem& problem, Factorization by, const PredictedSizes* predicted)
    : problem_(problem), by_(by), predicted_(predicted) {
  if (const Quantity* opening = heaviest_opening(problem.quantities))
    pulled_ = std::make_unique<Estimation>(pulled_body(*opening, problem), by, predicted);
  // How many unknowns there are does not depend on them, and to ask for them may take long.
  for (auto& [part, condition] : problem_.boundary) {
    if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = Field(0);
    if (auto* fixed = std::get_if<Fixed>(&condition)) fixed->value = VectorField();
  }
  for (const std::string& name : part_names(problem_.domain)) {
    const auto condition = problem_.boundary.find(name);
    conditions_.push_back(condition == problem_.boundary.end() ? nullptr : &condition->second);
  }
  const auto* polygon = std::get_if<Polygon>(&problem_.domain);
  chains_.assign(conditions_.size(), polygon ? 0 : 1);
  if (polygon)
    for (const int part : parts_of(*polygon).of_side) ++chains_[part];
  if (const auto* data = std::get_if<MeshData>(&problem_.domain))
    for (std::size_t part = 0; part < conditions_.size(); ++part)
      if (condition<Contact>(part))
        chains_[part] = nodes_beyond_edges(data->points, data->boundary[part].second, turns(part));
}

/// The pieces of a mesh; `edges_of(part)` has pairs of points.
template <typename EdgesOfPart>
void Estimation::cut(const std::vector<Point>& points, const std::vector<std::array<int, 3>>& triangles,
                     const EdgesOfPart& edges_of, Shows shows) {
  std::vector<MeshPieces::Edges> edges;
  for (std::size_t part = 0; part < conditions_.size(); ++part) edges.push_back(edges_of(part));
  std::vector<std::pair<const Condition*, const MeshPieces::Edges*>> boundary;
  for (std::size_t part = 0; part < conditions_.size(); ++part)
    boundary.emplace_back(conditions_[part], &edges[part]);
  are_alike_ = shows == Shows::itself && is_constant(problem_.material) && !problem_.mesh.adaptive;
  pieces_.emplace(points, triangles, boundary, components(problem_.material), are_alike_);
}

void Estimation::cut(const Mesh& mesh, Shows shows) {
  cut(
      mesh.points, mesh.triangles,
      [&](std::size_t part) {
        MeshPieces::Edges edges;
        for (const int edge : mesh.boundary[part].edges) edges.push_back(mesh.edges[edge]);
        return edges;
      },
      shows);
}

/// Uniform refinements are made as long as they have no more triangles than these, and few.
void Estimation::cut_finer(Mesh mesh, std::int64_t triangles, Shows shows) {
  const std::int64_t most = std::min({triangles, most_cut, may_be_cut_});
  Mesh before;
  while (4 * static_cast<std::int64_t>(mesh.triangles.size()) <= most)
    before = std::exchange(mesh, refine(mesh, 1));
  may_be_cut_ -= static_cast<std::int64_t>(mesh.triangles.size());
  const bool is_known = static_cast<std::int64_t>(mesh.triangles.size()) >= triangles;
  std::shared_ptr<const MeshPieces> coarser;
  // Triangles that are made are not thin.
  if (!is_known && !before.triangles.empty() && std::holds_alternative<MeshData>(problem_.domain)) {
    cut(before, shows);
    coarser = std::make_shared<const MeshPieces>(*std::move(pieces_));
  }
  cut(mesh, shows);
  pieces_->grow_as_from(std::move(coarser));
}

void Estimation::cut(const MeshData& data) {
  cut(
      data.points, data.triangles, [&](std::size_t part) { return data.boundary[part].second; },
      Shows::itself);
}

/// Before refinements. The schemes of a study have the same meshes, and coarser ones in common: of a polygon
/// without local sizes they are found once.
MeshSizes Estimation::sizes_by(const MeshRequest& request) {
  if (!std::holds_alternative<Polygon>(problem_.domain) || !request.sizes.empty())
    return (*predicted_)(request);
  const auto [known, is_new] = of_lengths_.try_emplace(std::get<LargestEdge>(request.fineness).length);
  if (is_new) known->second = (*predicted_)(request);
  return known->second;
}

/// The request for edges twice as long, or four times, until the polygon's mesh has few triangles. If its
/// vertices or its narrow places ask for more, whatever the size, it is one with twice as many, or none.
std::optional<Estimation::Coarser> Estimation::coarser_mesh(std::int64_t triangles) {
  constexpr int attempts = 3;
  std::optional<Coarser> larger;
  // By Euler's formula.
  const std::size_t holes = std::get<Polygon>(problem_.domain).holes.size();
  const auto least = std::reduce(chains_.begin(), chains_.end(), 2 * static_cast<std::int64_t>(holes) - 2);
  if (least > most_of_own_shape) return larger;
  double times = longer_for(triangles, few_triangles);
  for (int attempt = 0; attempt < attempts && may_be_tried_ > 0; ++attempt, times *= 2) {
    --may_be_tried_;
    const MeshRequest request = coarser(problem_.mesh, times);
    const std::int64_t made = sizes_by(request).triangles;
    if (made <= few_triangles) return Coarser{request, true};
    if (made <= most_of_own_shape && !larger) larger = {request, false};
  }
  return larger;
}

/// One of no more than `most` triangles, and no more than may be made, if there is such a one; to find that
/// there is none takes as long.
std::optional<Mesh> Estimation::make(const MeshRequest& request, std::int64_t most) {
  most = std::min(most, may_be_made_);
  std::optional<Mesh> mesh = make_small_mesh(problem_.domain, request, most);
  may_be_made_ -= mesh ? static_cast<std::int64_t>(mesh->triangles.size()) : most;
  return mesh;
}

/// What becomes of a given mesh that is not made, if it has many bodies of a few triangles, which the solve
/// halves.
MeshSizes Estimation::with_small_bodies(const MeshData& data, const MeshSizes& sizes) {
  constexpr std::int64_t of_large_bodies = 8;  // triangles or more, for an edge of the boundary
  if (sizes.triangles > of_large_bodies * sizes.edges_of_parts()) return sizes;
  const auto [known, is_new] = stabilized_.try_emplace(problem_.scheme);
  if (is_new) known->second = stabilized(problem_, data, sizes);
  return known->second;
}

/// By a mesh of the shape of those that it asks for.
void Estimation::cut_coarser(const MeshRequest& coarse, std::int64_t triangles) {
  if (std::optional<Mesh> mesh = make(coarse, most_of_own_shape))
    cut_finer(std::move(*mesh), triangles, Shows::another);
}

std::int64_t Estimation::contact_unknowns_of_rectangle(const MeshSizes& sizes) const {
  // The sides in a ring, so that the neighbours of a side are the ones before and after it.
  constexpr std::array ring{"left", "bottom", "right", "top"};
  const auto part = [&](int side) {
    return static_cast<std::size_t>(std::ranges::find(rectangle_parts(), ring[side]) -
                                    rectangle_parts().begin());
  };
  std::int64_t unknowns = 0;
  for (int side = 0; side < 4; ++side) {
    if (!condition<Contact>(part(side))) continue;
    unknowns += sizes.parts[part(side)].edges;
    if (problem_.scheme == Scheme::nonconforming) continue;
    ++unknowns;  // the nodes, less those that a fixed neighbour holds
    for (const int neighbour : {(side + 1) % 4, (side + 3) % 4})
      if (condition<Fixed>(part(neighbour))) --unknowns;
  }
  return unknowns;
}

/// The edges whose middle becomes a node, or two where a curved boundary turns an elastic body's normal
/// there.
std::int64_t Estimation::nodes_in_the_middle(std::size_t part, const MeshSizes& sizes) const {
  if (!condition<Contact>(part)) return 0;
  const auto& [edges, chords] = sizes.parts[part];
  return edges + (turns(part) ? chords : 0);
}

/// Those of a mesh before its refinements, nearly.
std::int64_t Estimation::contact_unknowns(const MeshSizes& sizes) const {
  const bool by_nodes = problem_.scheme == Scheme::conforming;
  std::int64_t unknowns = 0;
  for (std::size_t part = 0; part < conditions_.size(); ++part)
    if (condition<Contact>(part))
      unknowns += by_nodes ? nodes_in_the_middle(part, sizes) + chains_[part] : sizes.parts[part].edges;
  return unknowns;
}

/// Of the mesh that the problem asks for. Small ones are made.
Counts Estimation::count() {
  std::optional<Mesh> mesh;
  MeshSizes sizes = sizes_by(problem_.mesh);
  const bool is_large = std::holds_alternative<Polygon>(problem_.domain) && sizes.triangles > few_triangles;
  const std::optional<Coarser> coarse =
      is_large && may_be_made_ > 0 ? coarser_mesh(sizes.triangles) : std::nullopt;
  // Few, or half as many more where no coarser one of few shows the shape.
  const std::int64_t most = is_large && !(coarse && coarse->has_few) ? most_of_own_shape : few_triangles;
  // Of a rectangle a formula knows how it is cut, but not well which pieces are alike.
  const bool has_formula = is_rectangle() && (problem_.mesh.adaptive || !is_constant(problem_.material));
  // Each part of a given mesh takes as long as a triangle.
  const bool is_given = std::holds_alternative<MeshData>(problem_.domain);
  const auto cost = sizes.triangles + (is_given ? static_cast<std::int64_t>(conditions_.size()) : 0);
  if (!has_formula && cost <= std::min(most, may_be_made_)) mesh = make(problem_.mesh, most);
  if (mesh && problem_.mesh.refine == 0) mesh = stabilized(problem_, *std::move(mesh));
  if (mesh) sizes = sizes_of(*mesh);
  const std::int64_t triangles = refined(sizes, problem_.mesh.refine).triangles;
  if (mesh) {
    cut_finer(*mesh, triangles, Shows::itself);
  } else if (const auto* data = std::get_if<MeshData>(&problem_.domain)) {
    if (!pieces_) cut(*data);
    if (problem_.mesh.refine == 0 && !pieces_->empty()) sizes = with_small_bodies(*data, sizes);
  } else if (coarse && may_be_cut_ > 0) {
    cut_coarser(coarse->request, triangles);
  }
  std::int64_t contact = mesh ? make_clearance_space(problem_, *mesh).unknowns : contact_unknowns(sizes);
  for (int i = 0; i < problem_.mesh.refine; ++i) {
    if (problem_.scheme == Scheme::nonconforming) contact *= 2;
    for (std::size_t part = 0; problem_.scheme == Scheme::conforming && part < conditions_.size(); ++part)
      contact += nodes_in_the_middle(part, sizes);
    sizes = refined(sizes, 1);
  }
  if (is_rectangle()) contact = contact_unknowns_of_rectangle(sizes);
  return counts_of(sizes, contact);
}

Counts Estimation::counts_of(const MeshSizes& sizes, std::int64_t contact) const {
  Counts counts{sizes.triangles, sizes.edges, sizes.points};
  for (std::size_t part = 0; part < conditions_.size(); ++part) {
    const std::int64_t edges = sizes.parts[part].edges;
    if (condition<Fixed>(part)) counts.fixed_edges += edges;
    if (condition<Roller>(part) || condition<Contact>(part)) counts.normal_edges += edges;
  }
  counts.contact_unknowns = contact;
  counts.across = sizes.across;
  return counts;
}

/// The boundary grows as the root of the number of triangles. Every interior edge has two of them, and by
/// Euler there is about one point to two.
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
          boundary(start.contact_unknowns),
          start.across};
}

std::int64_t stress_unknowns(const Spaces& spaces, const Counts& counts) {
  const int inner = spaces.stresses() - 3 * spaces.traces_per_edge();
  return counts.edges * spaces.traces_per_edge() + counts.triangles * inner;
}

/// The part of the triangles that have a shape of their own, which no other shares. Those that are bisected
/// from few are often alike, and those of a refinement have two shapes, one turned round.
double Estimation::own_shapes(double triangles) const {
  constexpr double of_bisected = 0.5, of_refined = 2;
  if (!is_constant(problem_.material)) return 1;
  if (is_rectangle()) return problem_.mesh.adaptive ? of_bisected : 0;
  if (problem_.mesh.adaptive) return 1;
  if (pieces_ && are_alike_) return pieces_->shapes(triangles) / triangles;
  return std::min(1., of_refined / std::exp2(2 * problem_.mesh.refine));
}

Estimate Estimation::operator()() {
  const Counts counts = count();
  return estimate_of(problem_.mesh.adaptive ? grown(counts, *problem_.mesh.adaptive) : counts,
                     pulled_ ? std::optional((*pulled_)(problem_.mesh, problem_.scheme)) : std::nullopt);
}

Estimate Estimation::operator()(const Mesh& mesh) {
  cut(mesh);
  return estimate_of(counts_of(sizes_of(mesh), make_clearance_space(problem_, mesh).unknowns),
                     pulled_ ? std::optional((*pulled_)(mesh)) : std::nullopt);
}

/// `pulled`: that of the body that an opening's weight pulls, on the same mesh, if there is one.
Estimate Estimation::estimate_of(const Counts& counts, const std::optional<Estimate>& pulled) const {
  const Spaces& spaces = spaces_of(problem_.scheme, components(problem_.material));
  Estimate estimate;
  estimate.triangles = counts.triangles;
  estimate.unknowns = {stress_unknowns(spaces, counts), counts.triangles * spaces.displacements(),
                       counts.contact_unknowns, spaces.rotations() ? counts.points : 0};
  const std::int64_t held =
      (spaces.components * counts.fixed_edges + counts.normal_edges) * (spaces.order + 1);
  estimate.system =
      counts.edges * spaces.traces_per_edge() - held + estimate.unknowns.rotation + estimate.unknowns.contact;

  // Nested dissection fills a planar matrix of n unknowns with O(n log n) entries at O(n^1.5) operations;
  // the factors are fitted to measured solves.
  const double n = static_cast<double>(estimate.system),
               contact = static_cast<double>(counts.contact_unknowns);
  const double entries = n * std::log2(n + 2);
  // Each triangle has three sides, and each edge inside is one of two triangles.
  const auto boundary = static_cast<double>(2 * counts.edges - 3 * counts.triangles);
  const SolveSizes sizes{static_cast<double>(estimate.triangles),
                         n,
                         contact,
                         pieces_ ? &*pieces_ : nullptr,
                         counts.across,
                         own_shapes(static_cast<double>(estimate.triangles)),
                         boundary,
                         static_cast<double>(conditions_.size())};
  estimate.memory_bytes = memory_of_solve(problem_, spaces, sizes, by_, Afterwards::let_go);
  estimate.sweep_bytes = memory_of_solve(problem_, spaces, sizes, by_, Afterwards::used_again);
  estimate.paper_form_bytes = memory_of_paper_form(problem_, spaces, sizes, by_);
  if (!problem_.quantities.empty()) {
    const double of_dual = memory_of_dual(problem_, spaces, sizes.triangles);
    for (const auto& [bytes, factor_is] : {std::pair{&estimate.memory_bytes, Afterwards::let_go},
                                           std::pair{&estimate.sweep_bytes, Afterwards::used_again}}) {
      // The body that an opening's weight pulls is solved beside the problem.
      if (pulled)
        *bytes =
            std::max(*bytes, memory_at_rest(problem_, spaces, sizes, by_, factor_is) + pulled->memory_bytes);
      *bytes += of_dual;
    }
    estimate.kept_bytes = memory_of_kept_duals(problem_, spaces, sizes);
  }
  estimate.solution_bytes = memory_of_solution(spaces, sizes.triangles);
  if (problem_.mesh.adaptive) estimate.solution_bytes += memory_of_levels(spaces, sizes.triangles);
  estimate.entry_bytes = memory_of_entry(contact);
  estimate.helper_bytes = memory_of_helper(problem_, spaces, sizes);
  estimate.seconds = 1e-3 + 8e-8 * entries + 1.2e-9 * std::pow(n, 1.5) + 1e-10 * std::pow(contact, 3) +
                     seconds_of_law(problem_.material, spaces, sizes.triangles) +
                     seconds_of_shapes(problem_.material, spaces, sizes.own_shapes * sizes.triangles) +
                     seconds_of_quantities(problem_, sizes.triangles);
  return estimate;
}

}  // namespace signorini
