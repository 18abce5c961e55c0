#pragma once

#include "api/picture/picture.hpp"

namespace signorini::api {

/// The body in the plane, coloured by a field.
void draw_field(const Solution& solution, const Picture& picture, PieceWriter& out);

}  // namespace signorini::api
