#pragma once

#include "fem/scheme.hpp"
#include "problem/problem.hpp"

namespace signorini {

/// The numbers by which the memory of a solve goes.
struct SolveSizes {
  double triangles = 0;
  double system = 0;   ///< unknowns of the SPD system
  double contact = 0;  ///< contact unknowns
};

/// What a solve takes, in bytes, at its peaks: while it factors, and while it certifies. It takes no more,
/// and on grids of squares and on meshes of triangles that are about as wide as long more than half of it,
/// but for some megabytes of tables that not every solve has. The constants are sizes of what is allocated a
/// triangle, an unknown or a solve.
///
/// The factor is that of system/dissection.hpp on a grid of the given divisions. A mesh that is no grid
/// counts as a square one: what one of triangles that are much longer than wide takes is not foreseen.
double memory_of_solve(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes);

/// The same while the paper's iteration runs.
double memory_of_paper_form(const Problem& problem, const Spaces& spaces, const SolveSizes& sizes);

/// The Solution of a solve alone.
double memory_of_solution(const Spaces& spaces, double triangles);

/// The records of so many iterations, by the solve and by whoever observes it.
double memory_of_history(int iterations);

/// What a sweep keeps of an entry.
double memory_of_entry(double contact_unknowns);

}  // namespace signorini
