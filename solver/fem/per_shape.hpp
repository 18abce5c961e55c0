#pragma once

#include <array>
#include <concepts>
#include <cstring>
#include <memory>

#include "fem/discretization.hpp"

namespace signorini {

/// What follows from the shape of a triangle alone, made once for all triangles of the same shape that come
/// one after the other: where the material is constant, a structured mesh has but a few shapes. The last few
/// are remembered, so that other meshes lose nothing.
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
    const bool known = found && problem_.element.has_constant_material() && found->jacobian == jacobian;
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

  /// Mixes the bits of the numbers (Knuth's multiplicative hashing).
  static std::size_t place(const Eigen::Matrix2d& jacobian) {
    std::array<std::uint64_t, 4> bits;
    std::memcpy(bits.data(), jacobian.data(), sizeof bits);
    std::uint64_t mixed = 0;
    for (const std::uint64_t number : bits) mixed = (mixed ^ number) * 0x9e3779b97f4a7c15u;
    return mixed >> (64 - kBits);
  }

  const Discretization& problem_;
  std::array<std::unique_ptr<Remembered>, 1 << kBits> remembered_;
};

}  // namespace signorini
