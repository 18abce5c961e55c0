#pragma once

#include "certify/pressure/contact_pressure.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// The stress 0.
inline Eigen::MatrixXd no_stress(const Discretization& discrete) {
  return Eigen::MatrixXd::Zero(discrete.spaces().stresses(), discrete.triangles());
}

/// Its pressure, on a contact that is closed everywhere.
inline ContactPressure no_pressure(const Discretization& discrete) {
  return {discrete, no_stress(discrete),
          Eigen::VectorXd::Zero(static_cast<Eigen::Index>(discrete.clearance.rows.size()))};
}

}  // namespace signorini
