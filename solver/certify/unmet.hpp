#pragma once

#include "certify/admissible_pair.hpp"
#include "certify/data/law_pieces.hpp"

namespace signorini {

/// Why a bound by this pair would not hold, in words (THEORY.md, "Guaranteed, or unmet"), but for what
/// CarriedLoads says; empty if it holds.
std::vector<std::string> reasons_against(const Discretization& discrete, const Solution& solution,
                                         const AdmissiblePair& pair, const LawOnMesh& laws,
                                         Progress& progress);

/// That nothing takes what is carried.
std::string nothing_takes(const std::vector<ContactPressure::Lack>& lacks);

}  // namespace signorini
