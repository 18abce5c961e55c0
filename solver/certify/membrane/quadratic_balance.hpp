#pragma once

#include <optional>

#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// What σ_h lacks, on a membrane, to balance the quadratic parts of load and traction too, and not those
/// alone that the scheme sees (Π_h): on each triangle a function of RT2 with
///
///     div τ = Π_h f − Πf,   τn = Πt − Π_h t on Γ_F,   τn = 0 on the other edges.
class QuadraticBalance {
 public:
  explicit QuadraticBalance(const Discretization& discrete) : discrete_(discrete) {}

  /// τn |e| at both ends and in the middle of edge 0, 1, 2, and the divergence, times det J, at the nodes of
  /// P2.
  static constexpr int kFluxes = 9, kData = kFluxes + 6;
  using Data = Eigen::Matrix<double, kData, 1>;
  using Values = Eigen::Matrix<double, 2, kData>;

  /// Somewhere there is some.
  bool is_needed() const;

  /// None where the data are constant or balanced by σ_h.
  std::optional<Data> operator()(int t) const;

  /// Times the data, which must balance: τ at a point of the reference triangle, before the Piola map. Of the
  /// functions with these data, which differ by the curl of the cubic bubble, the least.
  static Values reference_values(const Point& reference);
  /// τ on a triangle at the points of the triangle rule.
  static StressAtPoints at_points(const AffineMap& map, const Data& data);

 private:
  /// τn at both ends and in the middle of an edge of Γ_F.
  Eigen::Vector3d lacking_on(int edge) const;

  const Discretization& discrete_;
};

}  // namespace signorini
