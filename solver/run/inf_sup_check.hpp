#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "problem/problem.hpp"
#include "problem/settings.hpp"
#include "progress/observer.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The spaces of a scheme on a mesh, and the constant of the Babuška–Brezzi condition for them
/// (fem/inf_sup.hpp).
struct InfSup {
  Scheme scheme;
  std::int64_t triangles;
  Unknowns unknowns;
  double constant;
};

/// That of the problem's scheme on its mesh, without a solve. Throws InvalidProblem for a mesh that refines
/// itself or has too many stress unknowns, and what inf_sup_in_time() throws.
InfSup inf_sup_of(const Problem& problem, const Settings& settings, Observer& observer);

/// inf_sup_constant() within what the time limit leaves. Throws SolveError too where that is too little, for
/// a TimeUp would end the solve that asks.
double inf_sup_in_time(const Problem& problem, const Mesh& mesh, const Settings& settings,
                       Observer& observer);

/// Why the constant is not computed for so many stress unknowns; nothing if it is.
std::optional<std::string> too_large_for_inf_sup(std::int64_t stress_unknowns);

}  // namespace signorini
