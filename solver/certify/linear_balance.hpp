#pragma once

#include <optional>

#include "certify/load_values.hpp"
#include "fem/traction_field.hpp"

namespace signorini {

/// What σ_h of the nonconforming scheme lacks, on a membrane, to balance the linear parts of load and
/// traction too, and not their means alone: on each triangle the function of RT1 with
///
///     div τ = Π₀f − Π₁f,   τn = Π₁t − Π₀t on Γ_F,   τn = 0 on the other edges.
class LinearBalance {
 public:
  explicit LinearBalance(const Discretization& problem)
      : problem_(problem), traction_(problem.problem, problem.mesh) {}

  using Coefficients = Eigen::Matrix<double, 8, 1>;

  /// In the basis of fem/raviart_thomas.hpp; none where the data are constant or balanced by σ_h.
  std::optional<Coefficients> operator()(int t, LoadValues<1>& load) const;

 private:
  const Discretization& problem_;
  TractionField traction_;
};

}  // namespace signorini
