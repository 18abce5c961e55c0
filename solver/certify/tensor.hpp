#pragma once

#include <Eigen/LU>

#include "problem/material.hpp"

namespace signorini {

/// A stress, a strain or a gradient of D components, row by row: (x, y) for a membrane, (xx, xy, yx, yy) for
/// an elastic body.
template <int D>
using Tensor = Eigen::Matrix<double, 2 * D, 1>;

template <int D>
using TensorMap = Eigen::Matrix<double, 2 * D, 2 * D>;

/// C and E = C⁻¹ at a point, both on all tensors (see compliance_at).
template <int D>
struct Law {
  Law() : compliance(TensorMap<D>::Zero()), stiffness(TensorMap<D>::Zero()) {}
  explicit Law(const TensorMap<D>& c) : compliance(c), stiffness(c.inverse()) {}

  TensorMap<D> compliance, stiffness;
};

/// The law at points of the domain; a constant one is evaluated once.
template <int D>
class LawField {
 public:
  explicit LawField(const Material& material) : material_(material), constant_(is_constant(material)) {}

  /// Valid until the next call.
  const Law<D>& operator()(const Point& x) {
    if (!known_ || !constant_) last_ = Law<D>(TensorMap<D>(compliance_at(material_, x)));
    known_ = true;
    return last_;
  }

 private:
  const Material& material_;
  bool constant_, known_ = false;
  Law<D> last_;
};

}  // namespace signorini
