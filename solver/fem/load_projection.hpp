#pragma once

#include <deque>
#include <vector>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"
#include "progress/in_parts.hpp"

namespace signorini {

struct CellBudget;

/// The body load f on one triangle as scheme and certificate see it: by its projection Π₂f onto P2, which
/// does the work of f on what is quadratic, and by the Πf that stresses balance. That is Π₂f, or the
/// projection onto P1 where f jumps: to balance what it has between P1 and P2, too, would cost more than to
/// leave that with the rest.
struct ProjectedLoad {
  using Nodes = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 2, 6>;

  /// Π₂f and Πf at the corners and at the middles of edge 0, 1, 2; a row a component.
  Nodes projection, balanced;
  double rest = 0, unbalanced = 0;  ///< ‖f − Π₂f‖ and ‖f − Πf‖ are at most this
  /// (f − Πf, φ) is at most this times max |φ|, for linear and for quadratic φ.
  double uncertain_force = 0, uncertain_work = 0;
  bool jumps = false;  ///< Πf is Π₁f in a component that jumps

  bool operator==(const ProjectedLoad&) const = default;
  /// Of f + z q, with that of q on the same triangle. What both may be off by adds up.
  ProjectedLoad plus(double z, const ProjectedLoad& other) const;
};

/// The load of a problem on all triangles of its mesh.
class LoadProjection {
 public:
  /// `progress` may be null; else throws what it throws.
  LoadProjection(const Problem& problem, const Mesh& mesh, Progress* progress = nullptr);

  const ProjectedLoad& operator[](int t) const {
    return found_.all[found_.number_of.empty() ? 0 : found_.number_of[t]];
  }
  /// It is not known to be 0.
  bool is_any() const { return varies() || !found_.all[0].projection.isZero(0); }
  /// f is not the same all over some triangle.
  bool varies() const { return !found_.number_of.empty(); }
  /// Why what it says of f is not certain; empty if it is.
  const std::vector<std::string>& unmet() const { return found_.unmet; }

 private:
  /// What is found of triangles that follow each other.
  struct Found {
    std::deque<ProjectedLoad> all;  ///< grows without being copied: that of a large mesh takes half a second
    std::vector<int> number_of;     ///< of each triangle that in `all`
    bool first_may_be_shared = false, last_may_be_shared = false;
    std::vector<int> rough;  ///< triangles that could do with more cells
    std::vector<std::string> unmet;

    /// Of the next triangle; if it is that of the last one and neither is to change, both share it.
    void take(ProjectedLoad load, bool may_be_shared = true);
    void append(Found next);
  };

  /// `largest`: of |f|, here and below.
  static Found find(const VectorField& body, const Mesh& mesh, const ProjectedLoad& constant, double largest,
                    Part part, Progress& progress);
  /// Returns false if a component could do with more cells than its share of the budget.
  static bool project_on(const VectorField& body, const std::array<Point, 3>& corners, double largest,
                         CellBudget& budget, ProjectedLoad& load, std::vector<std::string>& unmet);

  Found found_;  ///< without numbers if all triangles have one load
};

}  // namespace signorini
