#include "server/jobs/postgres/turns.hpp"

namespace signorini::server::postgres {

const std::string within_share =
    "(share IS NULL OR queue.memory + (SELECT coalesce(sum(leases.memory), 0) FROM leases "
    "WHERE leases.owner = queue.owner) <= share)";

const std::string turn_now =
    "coalesce((SELECT min(turn) FROM queue WHERE " + within_share + "), (SELECT min(turn) FROM queue), 0)";

}  // namespace signorini::server::postgres
