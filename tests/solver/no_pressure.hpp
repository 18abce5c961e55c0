#pragma once

#include "certify/pressure/contact_pressure.hpp"
#include "fem/discretization.hpp"

namespace signorini {

/// The stress 0.
inline Eigen::MatrixXd no_stress(const Discretization& problem) {
  return Eigen::MatrixXd::Zero(problem.spaces().stresses(), problem.triangles());
}

/// Its pressure, on a contact that is closed everywhere.
inline ContactPressure no_pressure(const Discretization& problem) {
  return {problem, no_stress(problem),
          Eigen::VectorXd::Zero(static_cast<Eigen::Index>(problem.clearance.rows.size()))};
}

}  // namespace signorini
