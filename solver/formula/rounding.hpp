#pragma once

#include "formula/formula.hpp"

namespace signorini {

/// What the value of a formula in doubles is off by at most, from the real number that its text says at this
/// point: the first order of a running error analysis (Higham, Accuracy and Stability of Numerical
/// Algorithms, 2002, section 3.3), with functions that the C library rounds by no more than one unit in the
/// last place. Where a comparison is decided by rounding, the error is that of the case that was taken.
/// Coordinates and normals are taken as given.
double rounding_of(const Formula& formula, double x, double y, double nx = 0, double ny = 0);

}  // namespace signorini
