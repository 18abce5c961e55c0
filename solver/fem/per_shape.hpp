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
    const Digits digits = leading_digits(AffineMap(problem_.mesh.corners(triangle)).jacobian);
    std::unique_ptr<Remembered>& found = remembered_[place(digits)];
    const bool known = found && problem_.element.has_constant_material() && found->digits == digits;
    if (!known) {
      if constexpr (std::invocable<Make>)
        found.reset(new Remembered{digits, make()});
      else
        found.reset(new Remembered{digits, make(problem_.element.matrices(problem_.mesh, triangle))});
    }
    return found->value;
  }

 private:
  /// The exponent of the largest entry of a Jacobian, and the entries in units of 2^-42 of that power of two:
  /// what a difference of coordinates is exact to on a few thousand divisions.
  struct Digits {
    int exponent;
    std::array<std::int64_t, 4> entries;

    bool operator==(const Digits&) const = default;
  };

  struct Remembered {
    Digits digits;
    Value value;
  };
  static constexpr int kBits = 6;

  static Digits leading_digits(const Eigen::Matrix2d& jacobian) {
    constexpr int digits = 42;
    Digits leading{std::ilogb(jacobian.cwiseAbs().maxCoeff()), {}};
    const double scale = std::scalbn(1., digits - leading.exponent);
    for (int i = 0; i < 4; ++i) leading.entries[i] = std::llrint(scale * jacobian(i));
    return leading;
  }

  /// Mixes the bits of the numbers (Knuth's multiplicative hashing).
  static std::size_t place(const Digits& digits) {
    std::uint64_t mixed = 0;
    for (const std::int64_t number : digits.entries)
      mixed = (mixed ^ static_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15u;
    return mixed >> (64 - kBits);
  }

  const Discretization& problem_;
  std::array<std::unique_ptr<Remembered>, 1 << kBits> remembered_;
};

}  // namespace signorini
