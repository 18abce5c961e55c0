#pragma once

#include <functional>

#include "fem/clearance_space.hpp"
#include "fem/element.hpp"
#include "fem/load_projection.hpp"
#include "fem/trace_space.hpp"
#include "fem/traction_field.hpp"
#include "mesh/mesh.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// A problem on its mesh: the spaces of its scheme with their data. Refers to both; its members
/// refer to each other.
struct Discretization {
  /// `progress`: asked while loads that vary are projected; throws what it throws.
  Discretization(const Problem& problem, const Mesh& mesh, Progress* progress = nullptr);
  /// With the body load projected already.
  Discretization(const Problem& problem, const Mesh& mesh, LoadProjection body, Progress* progress,
                 ClearanceOf of = ClearanceOf::solution);
  Discretization(const Discretization&) = delete;
  Discretization& operator=(const Discretization&) = delete;

  /// See make_clearance_space().
  void draw_near(double reach);

  int triangles() const { return static_cast<int>(mesh.triangles.size()); }
  const Spaces& spaces() const { return element.spaces(); }

  const Problem& problem;
  const Mesh& mesh;
  Element element;
  LoadProjection body;      ///< f
  TractionField traction;   ///< t
  Eigen::MatrixXd load;     ///< F = (Πf, v_i), a column a triangle
  Eigen::VectorXd couples;  ///< of the load, for each triangle; empty unless the spaces leave them
  ClearanceSpace clearance;
  TraceSpace traces;
  /// What acts on the coupling itself, an entry an unknown: <t, μ> on Γ_F, and against the rotation the
  /// couples of load and traction.
  Eigen::VectorXd coupling_load;

 private:
  void take_up_body_load(Progress* progress);
  void take_up_traction(Progress* progress);
};

/// <−σ_n, φ_i> for every row of the clearance space, the force that the foundation exerts, from the outward
/// fluxes of the triangles on Γ_C in x and y components.
void contact_forces(const Discretization& discrete, const std::function<LocalVector(int triangle)>& fluxes,
                    Eigen::VectorXd& forces);

}  // namespace signorini
