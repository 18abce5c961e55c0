#pragma once

#include "server/jobs/postgres/connection.hpp"

namespace signorini::server::postgres {

/// Brings the tables of a database to those of this version, once, whoever starts at the same time. Throws
/// CannotOpenStore if a newer version made them.
void migrate(Connection& connection);

}  // namespace signorini::server::postgres
