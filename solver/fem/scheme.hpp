#pragma once

#include "fem/raviart_thomas.hpp"
#include "problem/problem.hpp"

namespace signorini {

/// The spaces that a scheme pairs (solver/README.md, "The two schemes"), each fixed by the one degree k: rows
/// from RT_k with P_k normal traces, P_k discontinuous displacement, P_k traces on the edges. The clearance
/// is P0 on each contact edge for k = 0, and P1 for k = 1, continuous along each part but where its direction
/// turns. An elastic body has two rows and a P1 continuous rotation besides, and for k = 0 the bubble of
/// PEERS in each row.
///
/// Everything with components is numbered function by function, the components of one function together:
/// function a of row c is a · components + c.
struct Spaces {
  int order;
  int components;  ///< rows of the stress, components of displacement and trace
  const RaviartThomas& row;
  LocalMatrix divergence;         ///< (div τ_j, v_i); the same on every triangle
  LocalMatrix displacement_mass;  ///< (v_i, v_j) on a triangle, divided by twice its area
  LocalMatrix solenoidal;         ///< a basis of the stresses without divergence, by columns
  LocalMatrix lifting;            ///< of each divergence the shortest stress, divergence · lifting = 1

  int stresses() const { return static_cast<int>(divergence.cols()); }
  int displacements() const { return static_cast<int>(divergence.rows()); }
  int traces_per_edge() const { return components * (order + 1); }
  int rotations() const { return components == 2 ? 3 : 0; }  ///< of a triangle
  /// The displacement has no rotation of its own, so that the multiplier takes the couples of the loads.
  bool leaves_couples() const { return components == 2 && order == 0; }
};

const Spaces& spaces_of(Scheme scheme, int components);

}  // namespace signorini
