#pragma once

#include "certify/data/law_pieces.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// Entry t: ‖τ‖²_C on triangle t, from above, for a stress in the basis of the spaces, a column a triangle. A
/// law that is no polynomial makes it larger by what the rule may be off by (LawPiece::error_of_rule).
Eigen::VectorXd energy_norm_squares(const Discretization& discrete, const Eigen::MatrixXd& stress,
                                    const LawOnMesh& laws, Progress& progress);

}  // namespace signorini
