#pragma once

#include <vector>

#include "problem/problem.hpp"

namespace signorini {

std::vector<const Field*> fields_of(const Material& material);
std::vector<const Field*> fields_of(const Condition& condition);

/// What it takes to ask for a value of each: steps of about 10 ns.
double steps_of(const std::vector<const Field*>& fields);

}  // namespace signorini
