#pragma once

#include <array>
#include <vector>

namespace signorini {

/// The directed edges (pairs of point numbers) reordered so that each begins where the one before it ends,
/// as far as they form chains; chains, and where closed ones begin, in the order given.
std::vector<std::array<int, 2>> in_chains(const std::vector<std::array<int, 2>>& edges);

}  // namespace signorini
