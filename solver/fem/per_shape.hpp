#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <memory>

#include "fem/discretization.hpp"

namespace signorini {

/// What follows from the shape of a triangle alone, made once for all triangles of the same shape that come
/// one after the other: where the material is constant, a structured mesh has but a few shapes. The last few
/// are remembered, so that other meshes lose nothing.
///
/// Shapes that differ by rounding alone count as the same: the coordinates of i/48 of a length leave hardly
/// two triangles alike to the last bit.
template <typename Value>
class PerShape {
 public:
  explicit PerShape(const Discretization& problem) : problem_(problem) {}

  /// The value for a triangle, made if need be, from its matrices if `make` takes some; valid until the next
  /// call.
  template <typename Make>
  Value& operator()(int triangle, const Make& make) {
    const Eigen::Matrix2d jacobian = AffineMap(problem_.mesh.corners(triangle)).jacobian;
    std::unique_ptr<Remembered>& found = remembered_[place(jacobian)];
    const bool known =
        found && problem_.element.has_constant_material() && is_same(found->jacobian, jacobian);
    if (!known) {
      if constexpr (std::invocable<Make>)
        found.reset(new Remembered{jacobian, make()});
      else
        found.reset(new Remembered{jacobian, make(problem_.element.matrices(problem_.mesh, triangle))});
    }
    return found->value;
  }

 private:
  struct Remembered {
    Eigen::Matrix2d jacobian;
    Value value;
  };
  static constexpr int kBits = 6;
  /// What a difference of coordinates is exact to on a few thousand divisions.
  static constexpr double kRounding = 1e-12;

  /// Along x and y by themselves: a triangle may be much longer than high.
  static bool is_same(const Eigen::Matrix2d& one, const Eigen::Matrix2d& other) {
    const auto sizes = [](const Eigen::Matrix2d& jacobian) -> Eigen::Array2d {
      return jacobian.cwiseAbs().rowwise().maxCoeff();
    };
    return (sizes(one - other) <= kRounding * sizes(one)).all();
  }

  /// Mixes the leading digits of the numbers (Knuth's multiplicative hashing).
  static std::size_t place(const Eigen::Matrix2d& jacobian) {
    constexpr int digits = 24;
    const double scale = std::scalbn(1., digits - std::ilogb(jacobian.cwiseAbs().maxCoeff()));
    std::uint64_t mixed = 0;
    for (const double number : jacobian.reshaped())
      mixed = (mixed ^ static_cast<std::uint64_t>(std::llrint(scale * number))) * 0x9e3779b97f4a7c15u;
    return mixed >> (64 - kBits);
  }

  const Discretization& problem_;
  std::array<std::unique_ptr<Remembered>, 1 << kBits> remembered_;
};

}  // namespace signorini
