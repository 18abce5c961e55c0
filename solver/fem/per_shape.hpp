#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <memory>
#include <numbers>

#include "fem/discretization.hpp"

namespace signorini {

/// Values that follow from the shape of a triangle alone. The last few are remembered, for triangles of the
/// same shape that come soon after: a structured mesh has but a few shapes.
///
/// Shapes that differ by rounding alone count as the same: the coordinates of i/48 of a length leave hardly
/// two triangles alike to the last bit.
template <typename Value>
class ShapeMemory {
  static constexpr int kBits = 4;
  /// Shapes that come in turn, four in a crossed square, may have one place: the last ones are kept there.
  static constexpr int kAlike = 4;

 public:
  static constexpr int kMost = kAlike << kBits;  ///< shapes that are remembered

  explicit ShapeMemory(const AffineMap& first) : digits_per_length_(digits_per_length(first)) {}

  /// The value for a triangle, made if need be; valid until the next call.
  template <typename Make>
  Value& operator()(const Eigen::Matrix2d& jacobian, const Make& make) {
    auto& alike = remembered_[place(jacobian)];
    auto known = std::ranges::find_if(alike, [&](const std::unique_ptr<Remembered>& one) {
      return one && is_same(one->jacobian, jacobian);
    });
    if (known == alike.end()) {
      --known;
      known->reset(new Remembered{jacobian, make()});
    }
    std::rotate(alike.begin(), known, known + 1);
    return alike.front()->value;
  }

  /// The value for a triangle if it is remembered, else null.
  Value* find(const Eigen::Matrix2d& jacobian) {
    for (const std::unique_ptr<Remembered>& one : remembered_[place(jacobian)])
      if (one && is_same(one->jacobian, jacobian)) return &one->value;
    return nullptr;
  }

  template <typename Predicate>
  void forget_if(const Predicate& is_to_go) {
    for (auto& alike : remembered_)
      for (std::unique_ptr<Remembered>& one : alike)
        if (one && is_to_go(one->value)) one.reset();
  }

 private:
  struct Remembered {
    Eigen::Matrix2d jacobian;
    Value value;
  };
  /// What a difference of coordinates is exact to on a few thousand divisions.
  static constexpr double kRounding = 1e-12;

  /// Along x and y by themselves: a triangle may be much longer than high.
  static bool is_same(const Eigen::Matrix2d& one, const Eigen::Matrix2d& other) {
    const auto sizes = [](const Eigen::Matrix2d& jacobian) -> Eigen::Array2d {
      return jacobian.cwiseAbs().rowwise().maxCoeff();
    };
    return (sizes(one - other) <= kRounding * sizes(one)).all();
  }

  /// What makes whole numbers of some digits of the first triangle's coordinates. By the golden ratio simple
  /// fractions do not lie halfway between two numbers, where rounding would decide.
  static double digits_per_length(const AffineMap& first) {
    constexpr int digits = 24;
    return std::scalbn(std::numbers::phi, digits - std::ilogb(first.jacobian.cwiseAbs().maxCoeff()));
  }

  /// Mixes the leading digits of the numbers (Knuth's multiplicative hashing).
  std::size_t place(const Eigen::Matrix2d& jacobian) const {
    // Beside this number a double has no digits behind the point.
    constexpr double whole = 0x1.8p52;
    std::uint64_t mixed = 0;
    for (int i = 0; i < 4; ++i)
      mixed = (mixed ^ std::bit_cast<std::uint64_t>(digits_per_length_ * jacobian(i) + whole)) *
              0x9e3779b97f4a7c15u;
    return mixed >> (64 - kBits);
  }

  double digits_per_length_;
  std::array<std::array<std::unique_ptr<Remembered>, kAlike>, 1 << kBits> remembered_;
};

/// What follows from the shape of a triangle and its law: made once for all triangles of the same shape that
/// come one after the other where the material is constant, and for each where it is not.
template <typename Value>
class PerShape {
 public:
  explicit PerShape(const Discretization& discrete)
      : discrete_(discrete), remembered_(AffineMap(discrete.mesh.corners(0))) {}

  /// The value for a triangle, made if need be, from its matrices if `make` takes some; valid until the next
  /// call.
  template <typename Make>
  Value& operator()(int triangle, const Make& make) {
    const auto made = [&]() -> Value {
      if constexpr (std::invocable<Make>)
        return make();
      else
        return make(discrete_.element.matrices(discrete_.mesh, triangle));
    };
    if (discrete_.element.has_constant_material())
      return remembered_(AffineMap(discrete_.mesh.corners(triangle)).jacobian, made);
    last_ = std::make_unique<Value>(made());
    return *last_;
  }

 private:
  const Discretization& discrete_;
  ShapeMemory<Value> remembered_;
  std::unique_ptr<Value> last_;
};

}  // namespace signorini
