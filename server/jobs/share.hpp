#pragma once

#include <cstddef>
#include <optional>

namespace signorini::server {

/// What the jobs of one owner may take together; nothing: as much as everybody.
struct Share {
  std::optional<std::size_t> queue;  ///< jobs that wait
  std::optional<double> memory;  ///< bytes that its jobs which may run at the same time are predicted to take
  double weight = 1;  ///< its jobs take so many turns where those of another one take one; of a fleet
};

}  // namespace signorini::server
