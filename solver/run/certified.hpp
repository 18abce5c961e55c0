#pragma once

#include <memory>

#include "fem/discretization.hpp"
#include "problem/settings.hpp"
#include "progress/progress.hpp"
#include "result/solution.hpp"
#include "system/element_tree.hpp"

namespace signorini {

/// Adds Summary::certified to a solution with a guaranteed bound, in the phase certify; a quantity that is
/// what one contact takes is enclosed by that as well. Throws Cancelled. A discretization that is at hand, on
/// the solution's mesh, is not made again, nor a tree of its triangles.
void add_certified(const Problem& problem, const Settings& settings, Progress& progress, Solution& solution,
                   const Discretization* at_hand = nullptr, std::shared_ptr<const ElementTree> tree = {});

}  // namespace signorini
