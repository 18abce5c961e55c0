#pragma once

#include <map>
#include <string>
#include <vector>

#include "result/solution.hpp"

namespace signorini::api {

/// Lines along the foundation that an elastic body meets: its contact boundary, moved by so many times the
/// gap in the direction of the contact, or that of the normal where `contacts` names no other. What is
/// farther from the boundary than a quarter of the size of the body is left out, for beside it the body could
/// not be seen.
std::vector<std::vector<Point>> foundation(const Solution& solution,
                                           const std::map<std::string, Contact>& contacts, double times);

}  // namespace signorini::api
