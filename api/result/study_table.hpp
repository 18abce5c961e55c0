#pragma once

#include <vector>

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

namespace signorini::api {

/// Writes a study for a reader at a terminal: a scheme after the other, the columns of study_columns.hpp side
/// by side as far as a line is wide, the fitted rates below the observed ones. Returns false if the sink
/// ended it.
bool write_study_table(const std::vector<StudyRow>& rows, const Sink& sink);

}  // namespace signorini::api
