#pragma once

#include <Eigen/SparseCore>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Whether the rows of PEERS have their bubbles. Without them the pair is known to be unstable, which is what
/// they are left out for.
enum class Bubbles { kept, left_out };

/// The forms of the Babuška–Brezzi condition (solver/README.md, "The inf-sup constant") on the mesh, scaled
/// to area 1: lower triangles of symmetric matrices over the unknowns of σ, then of v, γ and μ, then of the
/// extension w of μ.
struct InfSupForms {
  Eigen::SparseMatrix<double> coupled;  ///< [A Bᵀ; B 0], and 0 for w
  Eigen::SparseMatrix<double> norms;    ///< the squares of the norms of v, γ and μ; 0 for σ
  int stresses = 0;
  int multipliers = 0;  ///< of v, γ and μ
  int extensions = 0;
};

/// σ has the conforming spaces of the problem's scheme, with the conditions on Γ_F, rollers and Γ_C built in.
/// Throws what Progress throws.
InfSupForms inf_sup_forms(const Problem& problem, const Mesh& mesh, Bubbles bubbles, Progress& progress);

}  // namespace signorini
