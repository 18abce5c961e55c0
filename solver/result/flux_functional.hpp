#pragma once

#include <vector>

#include "contact/operator.hpp"

namespace signorini {

/// A constant and a sum over boundary edges of weights times the outward fluxes of an edge, in x and y
/// components.
struct FluxFunctional {
  struct Edge {
    int edge;
    LocalVector weights;
  };
  double constant = 0;
  std::vector<Edge> edges;

  double operator()(const Discretization& discrete, const Eigen::MatrixXd& stress) const;
};

/// ∫ σn ds over a part, by components, and for an elastic body its moment ∫ x × σn ds about the origin; exact
/// for the traces of σ_h: the fluxes are its moments against the basis of the edge, in which x is linear;
/// where that leaves couples, those of the given traction are added.
std::vector<FluxFunctional> reactions_on(const Discretization& discrete, const BoundaryPart& part);

/// <−σ_n, φ_i> for a row of the clearance space.
FluxFunctional contact_force_on(const Discretization& discrete, int row);

/// How the functional grows with each contact unknown, everything else at rest: with y the forces K v for its
/// weights v, this is y_C − K_CI K_II⁻¹ y_I. One forward solve.
Eigen::VectorXd response(const FluxFunctional& functional, const Discretization& discrete,
                         const Operator& made, Factor::Workspace& workspace, Progress& progress);

}  // namespace signorini
