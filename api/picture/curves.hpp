#pragma once

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// Pressure and clearance along each contact part by arc length; where it touches is marked.
void draw_contact(const std::vector<ContactPart>& parts, PieceWriter& out);

/// The residuals of each iteration.
void draw_history(const std::vector<Iteration>& history, PieceWriter& out);

}  // namespace signorini::api
