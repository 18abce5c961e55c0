#pragma once

#include <array>
#include <optional>
#include <vector>

#include "certify/data/law_pieces.hpp"
#include "fem/discretization.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Loads of which no more is known than that |(q, φ)| ≤ F max |φ| for linear φ, with an F for each triangle
/// and for each of its edges.
struct UncertainLoads {
  explicit UncertainLoads(const Mesh& mesh)
      : on_triangles(mesh.triangles.size()), on_edges(mesh.triangles.size()) {}

  std::vector<double> on_triangles;
  std::vector<std::array<double, 3>> on_edges;
};

/// A bound of the least stress ‖τ‖_C that carries such loads, without traction but theirs and on Γ_D: of
/// their work on all displacements v that are 0 on Γ_D and have ‖ε(v)‖_E = 1. On each triangle v is a rigid
/// motion R_T v but for what its strain allows, motion_remainder(), and across an edge the motions of both
/// triangles differ by no more than the strains of both:
///
///     Σ_e ‖R_T v − R_T' v‖²_e / w_e  ≤  ‖ε(v)‖²_E,   w_e = Σ_{T, T'} n_T k²_{T,e} c_T,
///
/// n_T the number of edges of T that count, those inside and on Γ_D (where R_T' v stands for 0). With μ the
/// least of the left side over Σ F_T max_T |R_T v|² the bound is (Σ F_T / μ)^{1/2} for the work on R_T v, and
/// on each triangle √c_T (3 F K_T / √|T| + 2 Σ F_e k_{T,e} / √|e|) for that on v − R_T v. It does not depend
/// on the mesh but for its angles. On slivers, of which a factor would fill in, it is infinite.
///
/// `held`: without Γ_D the loads must be balanced; then a triangle of which the motion counts as none, for to
/// take a rigid motion off v changes nothing. All triangles must hang together with Γ_D or with it.
double carried_by_motions(const Discretization& discrete, const LawOnMesh& laws, const UncertainLoads& loads,
                          std::optional<int> held, Progress& progress);

}  // namespace signorini
