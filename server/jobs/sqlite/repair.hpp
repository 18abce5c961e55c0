#pragma once

#include <string>
#include <vector>

#include "server/jobs/sqlite/data_dir.hpp"

namespace signorini::server {

/// What was found in a database of jobs, in sentences for the operator.
struct Findings {
  std::vector<std::string> damage;  ///< empty: all is as it was written
};

enum class Depth {
  rows,  ///< how the file hangs together, and every row: soon done
  all,   ///< every problem and result too
};

/// Looks through the jobs of a directory and repairs what is damaged: a job of which something is not as it
/// was written is `failed` and says so, and if the file does not hang together its rows are brought into a
/// new one, and it is kept beside it as `jobs.sqlite.damaged`. `vfs` as for connect(). Throws
/// CannotOpenStore.
Findings repair(const DataDir& directory, Depth depth, const std::string& vfs = {});

}  // namespace signorini::server
