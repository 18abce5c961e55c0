#pragma once

#include <vector>

#include "certify/displacement/admissible_displacement.hpp"

namespace signorini {

/// ∫ t·v over Γ_F: t − Πt is orthogonal to v there, as far as it is known.
struct TractionWork {
  double value = 0;
  double slack = 0;  ///< it is off by no more
  double size = 0;   ///< with all signs taken as one: what rounding is measured by
};

/// Where the triangles have owners, an entry of at least 0.
TractionWork work_of_traction(const Discretization& discrete, const AdmissibleDisplacement& v,
                              const std::vector<int>& owners);

}  // namespace signorini
