#pragma once

#include <cstddef>

namespace signorini::server {

/// Bytes of memory that this process can come to have: those of the machine, or of its container if that has
/// fewer.
std::size_t machine_memory();

}  // namespace signorini::server
