#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// What minimize_stream_function() is to a membrane, for an elastic body in the conforming scheme: goes on
/// from the Airy function ψ of its pressure, which is any with p* ≥ 0, to the one that minimises
///
///     ‖σ* − sym σ_h‖²_C + <p*, g − v_n>,   p* ≥ 0,
///
/// over the ψ of the reduced element of Hsieh, Clough and Tocher in a few layers around the points where it
/// does not vanish, with p* kept on open edges. A primal active set like that one.
///
/// `clearance`: a value a row of the clearance space.
void minimize_airy(const Discretization& discrete, const Eigen::MatrixXd& stress,
                   const AdmissibleDisplacement& v, const Eigen::VectorXd& clearance,
                   ContactPressure& pressure, Progress& progress);

}  // namespace signorini
