#pragma once

#include <string>

#include "api/document/document_writer.hpp"
#include "server/handlers/find_job.hpp"
#include "server/jobs/scheduler.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

/// `/v1/solves/{id}`.
std::string link_to(const std::string& id);

/// `/v1/batches/{id}`.
std::string link_to_batch(const std::string& id);

/// How far a solve is, as members of an object.
void write_progress_members(api::DocumentWriter& out, const Progress& progress);

/// The status document of a job; `live` is its solve while it runs, else null.
void write_status(api::DocumentWriter& out, const Job& job, const LiveSolve* live);

/// The status documents of a page, and the link to the next one.
void write_list(api::DocumentWriter& out, const JobPage& page, const ListQuery& query,
                const LiveSolves& lives);

/// The residual history of a job, so far: of what it has as a result, else of its solve while it runs, if
/// there is one.
void write_history_so_far(api::DocumentWriter& out, const JobWithResult& about, const LiveSolve* live);

}  // namespace signorini::server
