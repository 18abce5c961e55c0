#pragma once

#include <string_view>

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// What a result says, to be read at a terminal: the summary in words, then levels and entries of a sweep as
/// tables. Returns false if the sink ended it.
bool write_result_table(std::string_view title, const Solution& solution, const Sink& sink);

}  // namespace signorini::api
