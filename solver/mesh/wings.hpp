#pragma once

#include <array>
#include <string>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

/// Parts of a domain that meet in a point but in no edge there are wings. A displacement of finite energy may
/// jump from one to the other, and so may its discrete counterpart: every wing but the first gets a point of
/// its own at the same place, after those that are given. Returns a sentence on these points, empty without
/// any.
///
/// `parts`: for each part of the boundary its edges, the domain on their left.
std::string separate_wings(std::vector<Point>& points, std::vector<std::array<int, 3>>& triangles,
                           std::vector<std::vector<std::array<int, 2>>>& parts);

}  // namespace signorini
