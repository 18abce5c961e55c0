#pragma once

#include <vector>

#include "problem/problem.hpp"

namespace signorini {

class Progress;

/// validate() of a sweep that may be long. It ends behind the variation with which the check has taken so
/// many steps, as steps_of() counts them. Throws what the progress throws, if there is one.
std::vector<Fault> faults_of_sweep(const Problem& problem, const std::vector<Variation>& sweep,
                                   double most_steps, Progress* progress);

}  // namespace signorini
