#pragma once

#include "certify/displacement/admissible_displacement.hpp"

namespace signorini {

/// ‖C σ_h − ε(v)‖²_E / ‖σ_h‖²_C as three points a triangle show it: no bound, but what the errors of the
/// rules are to be small beside.
double estimate_gap(const Discretization& discrete, const Eigen::MatrixXd& stress,
                    const AdmissibleDisplacement& v, Progress& progress);

}  // namespace signorini
