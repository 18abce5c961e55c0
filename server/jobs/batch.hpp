#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/jobs/job.hpp"

namespace signorini::server {

/// Jobs that were accepted together.
struct Batch {
  std::string id;
  std::string title;
  std::vector<std::string> tags;
  std::string owner;  ///< as in NewJob
  Time created;
  std::vector<std::string> jobs;  ///< ids of all, in the order of the problems, also of those that are gone
};

/// A batch as it is accepted. Each job says which batch it is of.
struct NewBatch {
  Batch batch;
  std::vector<NewJob> jobs;
  std::optional<std::string> key;  ///< by which the client tells a repeated request from a new one
  std::string digest;              ///< of the request, by which that is seen to be the same
};

/// What has ended of a batch.
struct BatchEnds {
  std::vector<std::string> jobs;  ///< ids, in the order in which they ended
  std::int64_t latest = 0;        ///< when the last of them ended, by a clock of the store
  bool all = true;                ///< the others are gone
};

}  // namespace signorini::server
