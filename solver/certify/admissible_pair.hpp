#pragma once

#include "certify/admissible_displacement.hpp"
#include "certify/contact_pressure.hpp"

namespace signorini {

/// v, and σ* by the pressure that it has on Γ_C.
struct AdmissiblePair {
  AdmissibleDisplacement v;
  ContactPressure pressure;
};

}  // namespace signorini
