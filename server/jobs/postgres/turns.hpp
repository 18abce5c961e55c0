#pragma once

#include <string>

namespace signorini::server::postgres {

// Expressions of SQL.

/// Whether the solves of the owner of a row of `queue` leave the memory for it that they may take together.
extern const std::string within_share;

/// The turn that it is: of the first job that may begin; if there is none, of the first one.
extern const std::string turn_now;

/// So many turns a job may be passed by others: by those whose operator is at hand, and by smaller ones while
/// there is not the memory for it. Each owner has so many jobs of weight 1 in there.
constexpr int turns_of_passing = 16;

}  // namespace signorini::server::postgres
