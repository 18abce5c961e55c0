#pragma once

#include <optional>

#include "certify/displacement/relaxation.hpp"

namespace signorini {

/// What QuadraticBalance takes from a triangle it gives back in the same triangle, and more than that costs
/// the least stress. The quadratic Ψ, 0 on Γ_F and Γ_C, that makes ‖β + curl Ψ‖_C small for its function β,
/// by a few steps of relax(). None where the balance lacks nothing, and for an elastic body.
std::optional<QuadraticValues> stream_function_of_balance(const Discretization& discrete, Progress& progress);

}  // namespace signorini
