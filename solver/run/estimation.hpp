#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "memory_estimate.hpp"
#include "mesh/domain_mesh.hpp"
#include "mesh/mesh_sizes.hpp"
#include "solve.hpp"

namespace signorini {

/// The sizes of a mesh, and how many edges and clearance unknowns its conditions concern.
struct Counts {
  std::int64_t triangles = 0, edges = 0, points = 0;
  std::int64_t fixed_edges = 0, normal_edges = 0;  ///< on Γ_D; on rollers and contact
  std::int64_t contact_unknowns = 0;
  double across = 0;  ///< MeshSizes::across
};

/// The sizes that a mesh may grow to.
Counts grown(const Counts& start, const Adaptive& goal);

std::int64_t stress_unknowns(const Spaces& spaces, const Counts& counts);

/// Of enclosing all quantities, as measured, on so many triangles.
double seconds_of_quantities(const Problem& problem, double triangles);

/// The estimates of a problem by all its meshes and schemes, which have its domain and its conditions in
/// common.
class Estimation {
 public:
  /// `predicted`: of the domain's meshes that are not there; null for estimates on one that is.
  Estimation(const Problem& problem, Factorization by, const PredictedSizes* predicted);

  /// By its own mesh and scheme.
  Estimate operator()();

  /// On a mesh that is there.
  Estimate operator()(const Mesh& mesh);

  /// By another of its meshes and schemes.
  Estimate operator()(const MeshRequest& mesh, Scheme scheme) {
    problem_.mesh = mesh;
    problem_.scheme = scheme;
    return (*this)();
  }

 private:
  /// Whether the mesh that is cut is the one that is solved on, or that one before uniform refinements, or
  /// another that but shows the shape of its pieces: then they are not alike where those are.
  enum class Shows { itself, another };

  /// A mesh that shows the shape of a finer one.
  struct Coarser {
    MeshRequest request;
    bool has_few;  ///< triangles
  };

  /// Meshes of so many triangles are cut into pieces to see what their factor takes.
  static constexpr std::int64_t most_cut = 4 * few_triangles;

  /// And so many are made if no mesh of few shows the shape: some twentieth of a second at most, together.
  static constexpr std::int64_t most_of_own_shape = 9 * few_triangles / 4;

  bool is_rectangle() const { return std::holds_alternative<Rectangle>(problem_.domain); }
  /// Of a part; null if it has another condition.
  template <typename Of>
  const Of* condition(std::size_t part) const {
    return std::get_if<Of>(conditions_[part]);
  }

  /// Whether what is not to be penetrated follows the normal of a part, and jumps where that turns.
  bool turns(std::size_t part) const {
    return components(problem_.material) == 2 && condition<Contact>(part)->direction.isZero(0);
  }

  MeshSizes sizes_by(const MeshRequest& request);
  Counts count();
  Counts counts_of(const MeshSizes& sizes, std::int64_t contact) const;
  Estimate estimate_of(const Counts& counts, const std::optional<Estimate>& pulled) const;
  template <typename EdgesOfPart>
  void cut(const std::vector<Point>& points, const std::vector<std::array<int, 3>>& triangles,
           const EdgesOfPart& edges_of, Shows shows);
  void cut(const Mesh& mesh, Shows shows = Shows::itself);
  void cut(const MeshData& data);
  MeshSizes with_small_bodies(const MeshData& data, const MeshSizes& sizes);
  void cut_finer(Mesh mesh, std::int64_t triangles, Shows shows);
  std::optional<Mesh> make(const MeshRequest& request, std::int64_t most);
  void cut_coarser(const MeshRequest& coarse, std::int64_t triangles);
  std::optional<Coarser> coarser_mesh(std::int64_t triangles);
  std::int64_t contact_unknowns_of_rectangle(const MeshSizes& sizes) const;
  std::int64_t contact_unknowns(const MeshSizes& sizes) const;
  std::int64_t nodes_in_the_middle(std::size_t part, const MeshSizes& sizes) const;
  double own_shapes(double triangles) const;

  Problem problem_;
  const Factorization by_;
  const PredictedSizes* const predicted_;
  std::unique_ptr<Estimation> pulled_;            ///< of the body that openings' weights pull
  std::vector<const Condition*> conditions_;      ///< of the parts
  std::vector<int> chains_;                       ///< of the parts, at most: nodes more than edges
  int may_be_tried_ = 12;                         ///< coarser meshes
  std::int64_t may_be_made_ = most_of_own_shape;  ///< together, of meshes that are made to be counted
  std::int64_t may_be_cut_ = 2 * most_cut;        ///< of those, and of their refinements
  std::optional<MeshPieces> pieces_;              ///< of a mesh that is made, or given
  std::map<Scheme, MeshSizes> stabilized_;        ///< of a given mesh that is not made
  std::map<double, MeshSizes> of_lengths_;        ///< of a polygon, by the largest edge
  bool are_alike_ = false;                        ///< pieces that are so on the mesh that is solved on
};

}  // namespace signorini
