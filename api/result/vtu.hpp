#pragma once

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// Writes the fields as a VTK XML file (.vtu, UnstructuredGrid) with appended raw little-endian data.
/// Returns false if the sink ended it.
///
/// Every triangle has three points of its own, and behind them every edge of the boundary, a line, two, so
/// that what jumps still does:
/// - point data `displacement`: u_h as it is, P0 or discontinuous P1; `displacement_continuous`: the
///   reconstruction of `displacement.at_points`. A number for a membrane, (u_x, u_y, 0) for a body. If there
///   is a contact, `clearance` and `pressure` on its lines, not a number elsewhere.
/// - cell data `stress` at the centroids: (σ_x, σ_y, 0) for a membrane; the six components XX, YY, ZZ, XY,
///   YZ, XZ for a body, with σ_zz, and `von_mises`; if there is an error bound, `error_density`, whose
///   integral is its square; `part`, the number of a line's part in the order of the mesh, and −1 for a
///   triangle. A line has the rest from its triangle.
bool write_vtu(const Solution& solution, const Sink& sink);

}  // namespace signorini::api
