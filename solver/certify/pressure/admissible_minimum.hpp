#pragma once

#include <array>
#include <vector>

#include <Eigen/SparseCore>

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "certify/pressure/free_unknowns.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// p* at one end of an edge of the clearance space, which changes with the unknowns.
struct MovingPressure {
  int edge, end;
  double value;
  LinearForm change;
  double room;   ///< (g − v_n, φ) with the hat φ of this end
  bool is_kept;  ///< it stays what it is
};

/// Those of both ends of edge i of the clearance space, which stay what they are where the contact is open or
/// the pressure steep, and in a dual problem.
///
/// `clearance`: a value a row of the clearance space.
std::array<MovingPressure, 2> moving_pressures(const Discretization& discrete,
                                               const AdmissibleDisplacement& v,
                                               const Eigen::VectorXd& clearance,
                                               const ContactPressure& pressure, int i,
                                               std::array<LinearForm, 2> changes);

/// The x that minimises ½ x·curvature x + slope·x + <p*, g − v_n> with row·x = 0 for the conditions, as far
/// as p* ≥ 0 allows, where p* starts with its values. A primal active set: it goes towards the minimum until
/// a pressure vanishes, keeps that, and goes on. p* ≥ 0 holds after every step, so that the last one may end
/// anywhere. The curvature is used up: sparse matrices of Eigen 3.4 are copied where they should be moved.
Eigen::VectorXd admissible_minimum(Eigen::SparseMatrix<double>&& curvature, Eigen::VectorXd slope,
                                   std::vector<MovingPressure> moving, std::vector<LinearForm> conditions,
                                   Progress& progress);

/// Moves the pressures as the unknowns do.
void move(const std::vector<MovingPressure>& moving, const Eigen::VectorXd& x, ContactPressure& pressure);

}  // namespace signorini
