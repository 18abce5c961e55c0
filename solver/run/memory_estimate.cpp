#include "memory_estimate.hpp"

#include <algorithm>
#include <cmath>

#include "certify/data/law_pieces.hpp"
#include "certify/data/linear_remainder.hpp"
#include "certify/displacement/star_relaxation.hpp"
#include "fem/load_projection.hpp"
#include "fem/per_shape.hpp"
#include "fem/trace_space.hpp"
#include "mesh/rectangle.hpp"
#include "progress/in_parts.hpp"
#include "system/elimination.hpp"

namespace signorini {
namespace {

constexpr double kNumber = sizeof(double), kIndex = sizeof(int);
/// What the fronts and the allocator add to what is counted here, as measured: to a membrane less.
double slack(const Spaces& spaces) {
  return spaces.components == 1 ? 1.1 : 1.13;
}
/// Whether it is the same everywhere.
bool is_uniform(const VectorField& field) {
  return std::ranges::all_of(field.fields(), &Field::is_constant);
}

/// Whether hardly any triangle has a load of its own: neighbours share one.
bool has_few_values(const VectorField& field) {
  return std::ranges::all_of(field.fields(), [](const Field& own) {
    return own.is_constant() || (own.formula() && own.formula()->has_few_values());
  });
}

/// The part of a rectangle's contact edges that its sides along y have.
double upright_contact(const Problem& problem, int x, int y) {
  const auto edges = [&](const char* side, int divisions) {
    const auto found = problem.boundary.find(side);
    const bool touches = found != problem.boundary.end() && std::holds_alternative<Contact>(found->second);
    return touches ? divisions : 0;
  };
  const double upright = edges("left", y) + edges("right", y), level = edges("bottom", x) + edges("top", x);
  return upright > 0 ? upright / (upright + level) : 0;
}

/// Where a mesh refines itself is not known. It does so in a few places, which are cheaper to cut than a grid
/// that is as fine everywhere.
Grid grid_of(const Problem& problem, double triangles, bool repeated) {
  if (!std::holds_alternative<Rectangle>(problem.domain)) {
    const double n = std::sqrt(triangles / 2);
    return {n, n, 1, 1, false, 0, 0};
  }
  const auto& rectangle = std::get<Rectangle>(problem.domain);
  const auto [x, y] = divisions(rectangle, problem.mesh);
  const double finer =
      problem.mesh.adaptive ? std::sqrt(triangles / 2 / x / y) : std::exp2(problem.mesh.refine);
  const bool is_plain = problem.mesh.pattern == Pattern::right || problem.mesh.pattern == Pattern::left;
  const int kinds = is_plain ? 1 : 2;
  return {finer * x,
          finer * y,
          rectangle.size.x() / (finer * x),
          rectangle.size.y() / (finer * y),
          true,
          upright_contact(problem, x, y),
          repeated && is_constant(problem.material) && !problem.mesh.adaptive ? kinds : 0};
}

/// Cuts through arms that lie side by side may run along one of them: by so many times are their fronts
/// larger than those of a grid, at most, as measured on combs.
constexpr double kPanelsOfArms = 1.5, kStacksOfArms = 2.5;

/// And a coarser mesh that shows the shape of the pieces has fewer of its triangles near local sizes, and
/// other cuts, which matter where the factor is most of what there is.
constexpr double kNearLocalSizes = 1.25, kOfOtherCuts = 1.1;

/// Of crossed squares an odd number is cut through one of them: that cut is longer, and fewer pieces are
/// alike, as measured.
constexpr double kThroughCrossed = 1.33;
bool are_cut_through(const Problem& problem) {
  const auto* rectangle = std::get_if<Rectangle>(&problem.domain);
  if (rectangle == nullptr || problem.mesh.pattern != Pattern::crossed || problem.mesh.adaptive) return false;
  constexpr int often_even = 8;
  const auto [x, y] = divisions(*rectangle, problem.mesh);
  return x % often_even != 0 || y % often_even != 0;
}

FactorBytes dissected(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes, bool repeated) {
  FactorBytes made;
  const auto enlarge = [&](double panels, double stacks) { made.panels *= panels, made.stacks *= stacks; };
  if (sizes.pieces == nullptr || sizes.pieces->empty()) {
    made = factor_bytes(grid_of(problem, sizes.triangles, repeated), spaces, sizes.triangles, sizes.contact);
    enlarge(1 + sizes.across * (kPanelsOfArms - 1), 1 + sizes.across * (kStacksOfArms - 1));
  } else {
    made = sizes.pieces->factor_bytes(spaces, sizes.triangles, sizes.contact, repeated);
    if (std::holds_alternative<Polygon>(problem.domain) && sizes.pieces->triangles() < sizes.triangles) {
      const double larger = !problem.mesh.sizes.empty() ? kNearLocalSizes
                            : spaces.components == 2    ? kOfOtherCuts
                                                        : 1;
      enlarge(larger, larger);
    }
  }
  if (are_cut_through(problem)) enlarge(kThroughCrossed, kThroughCrossed);
  return made;
}

/// CHOLMOD joins small supernodes and stores the zeros between them: by so many times are its panels larger
/// than those of the dissection's pieces, at most, as measured.
constexpr double kJoined = 1.5;

/// `own_matrices`: of each triangle, so that no pieces are alike.
FactorBytes factor_of(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes, Factorization by,
                      bool own_matrices = false) {
  FactorBytes made = dissected(problem, spaces, sizes, by == Factorization::multifrontal && !own_matrices);
  if (by == Factorization::cholmod) made.panels *= kJoined;
  return made;
}

/// Of a triangle: points, corners, edges and who has them.
constexpr double kMesh = 60;

double numbers_of_fields(const Spaces& spaces) {
  return spaces.stresses() + spaces.displacements();
}

double dofs_per_triangle(const Spaces& spaces) {
  return 3. * spaces.traces_per_edge() + spaces.rotations();
}

/// A discretization of a triangle: its load, its degrees of freedom and those of half its edges' and points'
/// sides.
double discretization(const VectorField& body, const Spaces& spaces) {
  const double dofs = 1.5 * spaces.traces_per_edge() + (spaces.rotations() ? 0.5 : 0);
  const double own = dofs_per_triangle(spaces);
  const double couple = spaces.leaves_couples() ? 1 : 0;
  return kNumber * (spaces.displacements() + couple + dofs) + sizeof(CouplingDof) * dofs +
         kIndex * (own + 1.5) + memory_of_load(body);
}

/// The sum that is factored: numbers and place of a triangle, and the matrix of its shape.
double element_sum(const Spaces& spaces, double own_shapes) {
  const double own = dofs_per_triangle(spaces);
  return kIndex * (own + 1) + sizeof(Point) + own_shapes * kNumber * own * own;
}

/// What the factorisation takes beside the factor and the sum: its stacks, or the sparse matrix of CHOLMOD.
/// That is first one of triplets, then put together by rows and by columns; later there are three copies of
/// it, tables for each unknown, the largest update, and the part of the contact unknowns twice.
double while_factoring(const FactorBytes& made, const Spaces& spaces, const SolveSizes& sizes,
                       Factorization by) {
  if (by == Factorization::multifrontal) return made.stacks;
  constexpr double triplet = 24, entry = 16, copies = 3, tables_of_unknown = 12 * 8, wide_indices = 2;
  const double own = dofs_per_triangle(spaces), entries = sizes.triangles * own * (own + 1) / 2;
  const double assembling = (triplet + 2 * entry) * entries;
  const double eliminating = copies * entry * entries + made.stacks + wide_indices * made.fronts +
                             2 * kNumber * sizes.contact * sizes.contact;
  return tables_of_unknown * sizes.system + std::max(assembling - made.panels, eliminating);
}

/// What a triangle takes while the pair of an elastic body is relaxed: the form of its shape, the slope, its
/// unknowns, and the triangles at half a point.
double relaxation(double own_shapes) {
  constexpr double at_point = 100, unknowns = 4;
  return kIndex + sizeof(TriangleForms::Vector) + unknowns * (2 * kNumber + kIndex) + at_point / 2 +
         own_shapes * sizeof(TriangleForms::Matrix);
}

/// What the admissible stress takes while it becomes the best near the contact: the sparse form of its stream
/// function, of which its minimum under conditions makes copies. As measured of thin bodies, whose triangles
/// all take part. A membrane of the higher order has its patches instead.
double minimization(const Spaces& spaces, const SolveSizes& sizes) {
  constexpr double of_body = 48e3, of_body_lower = 3e3, of_membrane_lower = 10e3;
  const bool is_membrane = spaces.components == 1;
  const double of_contact = is_membrane ? (spaces.order == 0 ? of_membrane_lower : 0)
                                        : (spaces.order == 0 ? of_body_lower : of_body);
  const double triangles_at_contact = is_membrane ? 8 : 16;
  return of_contact * std::min(sizes.contact, sizes.triangles / triangles_at_contact);
}

/// The admissible pair and its shares, and the law if it varies.
double pair(const Problem& problem, const SolveSizes& sizes) {
  constexpr double of_pair = 170, of_cut = 64;
  return sizes.triangles * (of_pair + (is_constant(problem.material) ? 0 : sizeof(LawPiece) + of_cut));
}

/// What it takes to find the pair: of an elastic body first the best stress, then the best of the pair, by
/// the lower order both at once.
double finding_pair(const Spaces& spaces, const SolveSizes& sizes) {
  const int at_once = spaces.components == 1 ? 0 : spaces.order == 0 ? 2 : 1;
  return std::max(minimization(spaces, sizes), at_once * sizes.triangles * relaxation(sizes.own_shapes));
}

/// Whether all is known of the load and of the tractions.
bool are_loads_uniform(const Problem& problem) {
  return is_uniform(problem.body) && std::ranges::all_of(problem.boundary, [](const auto& part) {
           return has_uniform_load(part.second);
         });
}

/// What is not known of loads that may have any form: what carries it through the motions of the triangles,
/// the factor of the differences across all edges and what it is made of
/// (certify/data/motion_differences.hpp). That of a membrane takes no more than what is gone by then.
double carrying(const Problem& problem, const Spaces& spaces, double triangles) {
  if (spaces.components == 1 || are_loads_uniform(problem)) return 0;
  constexpr double motions = 3;
  const double edges = 1.5 * triangles;
  const double in_factor = kNumber * motions * motions * edges * std::log2(triangles + 2);
  const double of_edge = kNumber * 4 * motions * motions + kIndex * (2 * motions + 1) + sizeof(Point);
  return in_factor + edges * of_edge + triangles * sizeof(MotionRemainder);
}

/// Tables of what a load that jumps leaves, as measured.
double tables_of_jumps(const Spaces& spaces) {
  return spaces.components == 1 ? 3.9e6 : 0.6e6;
}

/// What each thread takes that certifies: tables of shapes, of what a load that jumps leaves, and the cells
/// or points of one triangle on which the law is cut into pieces. As measured.
double tables_of_thread(const Problem& problem, const Spaces& spaces) {
  const double of_shapes = 8e5, of_points = 4e6, of_cells = 3e5;
  return of_shapes + (is_uniform(problem.body) ? 0 : tables_of_jumps(spaces)) +
         (is_constant(problem.material) ? 0
          : spaces.components == 1      ? of_cells
                                        : of_points);
}

/// And patches of a membrane where its pressure changes.
double tables(const Problem& problem, const Spaces& spaces) {
  constexpr double of_patches = 3e6;
  return tables_of_thread(problem, spaces) + (spaces.components == 1 && spaces.order == 1 ? of_patches : 0);
}

}  // namespace

/// A jump meets few triangles, but a few may be jumped through everywhere.
double memory_of_load(const VectorField& body) {
  constexpr double of_jumps = 0.125;
  if (is_uniform(body)) return 0;
  return kIndex + (has_few_values(body) ? of_jumps : 1) * sizeof(ProjectedLoad);
}

bool has_uniform_load(const Condition& condition) {
  if (const auto* traction = std::get_if<Traction>(&condition)) return is_uniform(traction->value);
  if (const auto* pressure = std::get_if<Pressure>(&condition))
    return pressure->value.is_constant() && is_uniform(pressure->besides);
  return true;
}

namespace {

/// The Solution of a solve without its mesh.
double fields_of_solution(const Spaces& spaces, double triangles) {
  const double per_point = 0.5 * (spaces.components + (spaces.rotations() ? 1 : 0));
  const double at_centroid = spaces.components == 1 ? 2 : 4, share = 1;
  return triangles * kNumber * (numbers_of_fields(spaces) + per_point + at_centroid + share);
}

}  // namespace

double memory_of_solution(const Spaces& spaces, double triangles) {
  return triangles * kMesh + fields_of_solution(spaces, triangles);
}

/// Cells along the curve where a density jumps, as measured of the smallest discs, under laws that vary.
constexpr double kCellsOfJump = 14.5e6;

bool jumps(const VectorField& density) {
  return std::ranges::any_of(density.fields(), [](const Field& field) {
    return field.formula() && field.formula()->has_branches();
  });
}

/// As measured, in solutions, beside the load of the quantity where it varies.
double memory_of_dual(const Problem& problem, const Spaces& spaces, double triangles) {
  const bool varies = !std::ranges::all_of(problem.quantities, is_uniform, &Quantity::density);
  const double of_jumps = std::ranges::any_of(problem.quantities, jumps, &Quantity::density)
                              ? kCellsOfJump + tables_of_jumps(spaces)
                              : 0;
  return (spaces.components == 1 ? 2 : 5) * memory_of_solution(spaces, triangles) + of_jumps +
         (varies ? triangles * static_cast<double>(sizeof(ProjectedLoad)) : 0);
}

double memory_of_kept_dual(const Quantity& quantity, const Spaces& spaces, const SolveSizes& sizes) {
  constexpr double sides = 4;     // given, condensed, and at work, and that of the last solution
  constexpr double values = 2.2;  // of quadratic functions, with what is held of them
  const double of_balance = spaces.components == 1 ? values : 0;
  return sizes.triangles * (discretization(quantity.density, spaces) + kNumber * (1 + of_balance)) +
         memory_of_solution(spaces, sizes.triangles) + sides * kNumber * sizes.system;
}

double memory_of_kept_duals(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes) {
  double sum = 0;
  for (const Quantity& quantity : problem.quantities) {
    if (!quantity.openings.empty()) continue;
    const double own = memory_of_kept_dual(quantity, spaces, sizes);
    if (sum + own <= kRoomForDuals) sum += own;
  }
  return sum;
}

double memory_of_levels(const Spaces& spaces, double triangles) {
  constexpr double all = 3, share = 1, per_triangle = 0.5;  // points
  const double numbers = per_triangle * (2 + spaces.components) + share;
  return all * triangles * (kNumber * numbers + 3 * sizeof(int));
}

/// What an edge of the boundary takes more than one inside, with its points, and where there are more of them
/// than a strip of triangles has, the bodies that they make; and each part, for its conditions, names and
/// what it supports. As measured of strips, of triangles that touch no other, and of parts of one edge.
double on_boundary(const SolveSizes& sizes) {
  constexpr double of_edge = 200, of_body = 700, of_part = 2500;
  return of_edge * sizes.boundary + of_body * std::max(0., sizes.boundary - sizes.triangles) +
         of_part * sizes.parts;
}

/// What triangles of one shape share while their fields are found (system/recovery.cpp), of the shapes that
/// are remembered.
double shapes_of_recovery(const Problem& problem, const SolveSizes& sizes) {
  using Shape = std::pair<Elimination, StrainMoments>;
  const double most = is_constant(problem.material) ? ShapeMemory<Shape>::kMost : 1;
  return sizeof(Shape) * std::min(most, sizes.own_shapes * sizes.triangles);
}

namespace {

double complement_of(const SolveSizes& sizes) {
  return kNumber * sizes.contact * sizes.contact;
}

/// The factor, with the complement of the contact unknowns.
double whole(const FactorBytes& made, const SolveSizes& sizes) {
  return made.panels + made.fronts + complement_of(sizes);
}

/// The traces as they were found, and the solution.
double found(const Spaces& spaces, const SolveSizes& sizes) {
  return kNumber * sizes.system + fields_of_solution(spaces, sizes.triangles);
}

/// Whether the factor is there when the fields are found.
bool is_kept(const Problem& problem, Afterwards factor_is) {
  return factor_is == Afterwards::used_again || !problem.quantities.empty();
}

/// What there is once the error is bounded. Where the factor is used again there are other right sides, and
/// in a sweep two more complements.
double at_rest(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes, const FactorBytes& made,
               Afterwards factor_is) {
  const double others = 2 * kNumber * sizes.system;
  const double complements = factor_is == Afterwards::used_again ? 2 * complement_of(sizes) : 0;
  const double kept = is_kept(problem, factor_is) ? whole(made, sizes) + others + complements : 0;
  return kept + found(spaces, sizes) + sizes.triangles * kNumber * spaces.stresses() + pair(problem, sizes) +
         tables(problem, spaces);
}

/// A mesh that refines itself keeps the solution of the level before, and what is seen of all.
double all_along(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes) {
  const double before = problem.mesh.adaptive ? memory_of_solution(spaces, sizes.triangles) +
                                                    memory_of_levels(spaces, sizes.triangles)
                                              : 0;
  return sizes.triangles * (kMesh + discretization(problem.body, spaces)) + on_boundary(sizes) + before;
}

}  // namespace

double memory_of_solve(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes,
                       Factorization by, Afterwards factor_is) {
  const FactorBytes made = factor_of(problem, spaces, sizes, by);
  const double complement = complement_of(sizes);
  const double factor = whole(made, sizes);
  const double kept = is_kept(problem, factor_is) ? factor : 0;
  const double right = kNumber * sizes.system;
  const double factoring = factor + while_factoring(made, spaces, sizes, by) + right +
                           sizes.triangles * element_sum(spaces, sizes.own_shapes);
  // And what is made on the way to the fields.
  const double finding =
      factor + 4 * right + complement + found(spaces, sizes) + shapes_of_recovery(problem, sizes);
  // Dual problems factor the complement again, one after the other.
  const double certifying = at_rest(problem, spaces, sizes, made, factor_is) +
                            std::max(finding_pair(spaces, sizes) + carrying(problem, spaces, sizes.triangles),
                                     problem.quantities.empty() ? 0 : complement);
  // Extensions have the components in a point of a cut, where traces and rotations have more on a side.
  const double on_side = spaces.traces_per_edge() + (spaces.rotations() ? 1 : 0), d = spaces.components;
  const double of_factor = d * d / (on_side * on_side) * while_factoring(made, spaces, sizes, by);
  const double enclosing = kept + found(spaces, sizes) + of_factor +
                           d * d / (on_side * on_side) * made.panels +
                           sizes.triangles * (3 * d * sizeof(int) + sizeof(int) + sizeof(Point) +
                                              3 * kNumber * d + sizes.own_shapes * 9 * d * d * kNumber);
  return slack(spaces) *
         (all_along(problem, spaces, sizes) + std::max({factoring, finding, certifying, enclosing}));
}

double memory_of_helper(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes) {
  // The forms of a part grow, up to twice what they are.
  const double forms = spaces.components == 1 ? 0 : 2 * kPart * relaxation(sizes.own_shapes);
  return slack(spaces) *
         std::max(shapes_of_recovery(problem, sizes), tables_of_thread(problem, spaces) + forms);
}

double memory_at_rest(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes, Factorization by,
                      Afterwards factor_is) {
  const FactorBytes made = factor_of(problem, spaces, sizes, by);
  return slack(spaces) *
         (all_along(problem, spaces, sizes) + at_rest(problem, spaces, sizes, made, factor_is));
}

double memory_of_paper_form(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes,
                            Factorization by) {
  SolveSizes free = sizes;
  free.contact = 0;
  const FactorBytes made = factor_of(problem, spaces, free, by, true);
  const double own = dofs_per_triangle(spaces), displacements = spaces.displacements();
  // P and D, and the fields of an iterate; and K_r at each edge of the boundary.
  const double iteration = kNumber * displacements * (own + displacements + 5);
  const double at_boundary = kNumber * own * own * sizes.boundary;
  return slack(spaces) * (made.panels + made.fronts + while_factoring(made, spaces, free, by) +
                          3 * kNumber * sizes.system + on_boundary(sizes) + at_boundary +
                          sizes.triangles * (kMesh + discretization(problem.body, spaces) +
                                             element_sum(spaces, 1) + iteration));
}

double memory_of_inf_sup(const Spaces& spaces, double triangles) {
  constexpr double mesh = 2000, entry = 62;
  const double local = numbers_of_fields(spaces) + spaces.rotations();
  return triangles * (mesh + entry * local * local);
}

double memory_of_history(int iterations) {
  // Its own, the observer's, and a third while one of them grows, or goes into the result.
  constexpr double histories = 3;
  return histories * sizeof(Iteration) * std::exp2(std::ceil(std::log2(std::max(1, iterations))));
}

double memory_of_entry(double contact_unknowns) {
  constexpr double sums = 1400, of_row = 65;
  return sums + of_row * contact_unknowns;
}

}  // namespace signorini
