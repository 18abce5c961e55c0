#pragma once

#include "server/config.hpp"

namespace signorini::server {

/// Computes the inf-sup constant of the spaces on the mesh that a problem in a file asks for: it goes to
/// standard output, what went wrong as problem+json to standard error. Returns the exit code.
int run_inf_sup(const InfSupConfig& config);

}  // namespace signorini::server
