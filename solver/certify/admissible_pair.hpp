#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/membrane/balance_stream_function.hpp"
#include "certify/pressure/contact_pressure.hpp"

namespace signorini {

/// v, and σ* by the pressure that it has on Γ_C and, for a membrane, the stream function that spreads its
/// balance.
struct AdmissiblePair {
  AdmissibleDisplacement v;
  ContactPressure pressure;
  std::optional<QuadraticValues> of_balance = std::nullopt;

  /// Of a membrane: the stream function, on a triangle, whose curl σ* has besides σ_h and its balance.
  Quadratic<1> stream_function_on(const Mesh& mesh, int t) const {
    const Quadratic<1> of_pressure = pressure.stream_function_on(mesh, t);
    return of_balance ? Quadratic<1>(of_pressure + of_balance->on(mesh, t)) : of_pressure;
  }
};

}  // namespace signorini
