#pragma once

#include <cstddef>

namespace signorini::server {

/// Bytes of memory that this process can come to have: those of the machine, or of its container if that has
/// fewer.
std::size_t machine_memory();

/// What is freed is kept for what is taken next: pages that come anew from the system are cleared first,
/// which takes a tenth of a large solve. For a program that ends with its solve; a service would keep what
/// its largest one has taken.
void keep_freed_memory();

}  // namespace signorini::server
