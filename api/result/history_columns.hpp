#pragma once

#include "result/solution.hpp"

namespace signorini::api {

/// Calls `column(name, entry)` for every column of a history, in order; `entry(iteration)` is the number
/// that stands in it. `first`: the first iteration, or null if there is none.
template <typename Column>
void for_each_history_column(const Iteration* first, const Column& column) {
  column("iteration", [](const Iteration& i) { return i.number; });
  const bool paper_form = first != nullptr && first->displacement_change;
  if (paper_form)
    column("displacement_change", [](const Iteration& i) { return i.displacement_change.value(); });
  column("clearance_change", [](const Iteration& i) { return i.clearance_change; });
  column("equilibrium", [](const Iteration& i) { return i.equilibrium; });
  column("penetration", [](const Iteration& i) { return i.penetration; });
  column("tension", [](const Iteration& i) { return i.tension; });
  column("complementarity", [](const Iteration& i) { return i.complementarity; });
  column("active", [](const Iteration& i) { return i.active; });
  column("seconds", [](const Iteration& i) { return i.seconds; });
}

}  // namespace signorini::api
