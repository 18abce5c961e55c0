#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// Goes on from the stream function Ψ of a membrane's pressure, which is any with p* ≥ 0, to the one that
/// minimises
///
///     ‖curl Ψ − d‖²_C + <p*, g − v_n>,   p* = p_h + ∂_t Ψ ≥ 0,
///
/// over the quadratic Ψ of StreamFunctionNodes, with p* kept on open edges. Without d the stress changes
/// least, near the places where it does: both terms then weigh as they do in the bound where it matters, for
/// ‖C σ* − ε(v)‖² grows by about the first of them. With d the nodes are those of the whole mesh. A primal
/// active set: p* ≥ 0 holds after every step, so that each is an answer.
///
/// `clearance`: a value a row of the clearance space.
void minimize_stream_function(const Discretization& discrete, const AdmissibleDisplacement& v,
                              const Eigen::VectorXd& clearance, ContactPressure& pressure, Progress& progress,
                              const StressField& d = {});

}  // namespace signorini
