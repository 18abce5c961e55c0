#pragma once

#include "fem/edge_pieces.hpp"

namespace signorini {

/// A bound of the Taylor coefficients of this order, in s, on the whole edge: infinite where the field is not
/// smooth. Below `small` it need not be closer.
double largest_coefficient(const Field& field, const EdgeLine& line, int order, double small);

}  // namespace signorini
