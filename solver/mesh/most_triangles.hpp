#pragma once

namespace signorini {

/// Of any mesh: so that the numbers of its edges and unknowns are an `int` by far.
inline constexpr int most_triangles = 40'000'000;

}  // namespace signorini
