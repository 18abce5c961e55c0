#pragma once

#include "certify/elasticity/edge_tractions.hpp"
#include "certify/elasticity/johnson_mercier.hpp"

namespace signorini {

using JohnsonMercierData = Eigen::Matrix<double, JohnsonMercier::kData, 1>;

/// Traction data of the macro-element from tractions at both ends and in the middle of local edge e:
/// J⁻¹ t |e|.
Eigen::Matrix<double, 6, 1> traction_data(const AffineMap& map, int e,
                                          const Eigen::Matrix<double, 2, 3>& traction);

/// The data of σ* on triangle t: its tractions, and −det J J⁻¹ Πf for the divergence.
JohnsonMercierData johnson_mercier_data(const Discretization& discrete, const EdgeTractions& tractions, int t,
                                        const AffineMap& map);

}  // namespace signorini
