#pragma once

#include "api/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// Writes the fields as a VTK XML file (.vtu, UnstructuredGrid) with appended raw little-endian data.
/// Returns false if the sink ended it.
///
/// Every triangle has three points of its own, so that what jumps across an edge still does:
/// - point data `displacement`: u_h as it is, P0 or discontinuous P1; `displacement_continuous`: the
///   reconstruction of `displacement.at_points`. A number for a membrane, (u_x, u_y, 0) for a body.
/// - cell data `stress` at the centroids: (σ_x, σ_y, 0) for a membrane; the six components XX, YY, ZZ, XY,
///   YZ, XZ for a body, with σ_zz, and `von_mises`.
bool write_vtu(const Solution& solution, const Sink& sink);

}  // namespace signorini::api
