#pragma once

#include "factor_estimate.hpp"
#include "fem/scheme.hpp"
#include "problem/problem.hpp"
#include "problem/settings.hpp"

namespace signorini {

/// The numbers by which the memory of a solve goes.
struct SolveSizes {
  double triangles = 0;
  double system = 0;                   ///< unknowns of the SPD system
  double contact = 0;                  ///< contact unknowns
  const MeshPieces* pieces = nullptr;  ///< of the mesh, or of one that it comes from, where there is one
  double across = 0;                   ///< MeshSizes::across
  double own_shapes = 1;               ///< the part of the triangles that have a matrix of their own
  double boundary = 0, parts = 0;      ///< edges of the boundary, and parts that they belong to
};

/// What becomes of the factor once the fields are found.
enum class Afterwards { let_go, used_again };

/// What a solve takes, in bytes, at its peaks: while it factors, while it finds its fields, and while it
/// certifies, with the factor if that is used again, by quantities or a sweep. It takes no more, and more
/// than half of it, but for some megabytes of tables that not every solve has; thin columns on contact by the
/// lower order take up to an eighth more. The constants are sizes of what is allocated a triangle, an unknown
/// or a solve.
///
/// The factor is that of system/dissection.hpp: of the pieces of the mesh, or of a grid of the divisions. A
/// polygon whose mesh is still to be made counts as a square grid.
double memory_of_solve(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes,
                       Factorization by, Afterwards factor_is);

/// What a thread that helps a solve takes beside what the solve does: tables of its own, and a part of what
/// the triangles make, which waits for its turn.
double memory_of_helper(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes);

/// What such a solve holds once its error is bounded, while another body is solved for its quantities.
double memory_at_rest(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes, Factorization by,
                      Afterwards factor_is);

/// What a solve takes while the paper's iteration runs.
double memory_of_paper_form(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes,
                            Factorization by);

/// What the load takes of each triangle.
double memory_of_load(const VectorField& body);

/// Whether all is known of the load of a condition, if it has one: it is the same everywhere.
bool has_uniform_load(const Condition& condition);

/// The Solution of a solve alone.
double memory_of_solution(const Spaces& spaces, double triangles);

/// What enclosing quantities takes besides: a dual problem at a time with its pair, and that of the base.
double memory_of_dual(const Problem& problem, const Spaces& spaces, double triangles);

/// Bytes that a sweep may keep dual problems in: one takes one or two millions on a few thousand triangles.
inline constexpr double kRoomForDuals = 256e6;

/// What a sweep keeps of the dual problem of a quantity, and of all quantities of the problem.
double memory_of_kept_dual(const Quantity& quantity, const Spaces& spaces, const SolveSizes& sizes);
double memory_of_kept_duals(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes);

/// What the solution keeps of the levels of a mesh that refines itself, each of which has half as many
/// triangles again as the one before.
double memory_of_levels(const Spaces& spaces, double triangles);

/// What a study's check of the inf-sup condition takes: fitted to measured ones of up to 300 000 stress
/// unknowns, with a margin.
double memory_of_inf_sup(const Spaces& spaces, double triangles);

/// The records of so many iterations, by the solve and by whoever observes it.
double memory_of_history(int iterations);

/// What a sweep keeps of an entry.
double memory_of_entry(double contact_unknowns);

}  // namespace signorini
