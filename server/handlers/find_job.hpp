#pragma once

#include <string>

#include "api/result/result_document.hpp"
#include "server/handlers/service.hpp"
#include "server/http/error.hpp"
#include "server/http/request.hpp"

namespace signorini::server {

/// The id in the path.
const std::string& id_of(const Request& request);

/// 404: there is no solve with this id.
HttpError unknown_solve();

/// The job of the path. Throws HttpError 404, also for a job of somebody else.
Job find_job(Service& service, const Request& request);

struct JobWithResult {
  Job job;
  JobResult result;
};

/// The same, if it has a solution. Throws HttpError 404, 409 if it has not ended, 410 if it ended without
/// one.
Job find_solved(Service& service, const Request& request);

JobWithResult find_job_with_result(Service& service, const Request& request);

/// A job that has a solution, of which only the summary is wanted.
JobWithResult with_summary(Job job);

/// A job that has ended, and what it found out. Throws HttpError 404 if it was removed meanwhile, 410 if what
/// was stored is damaged.
JobWithResult with_result(Service& service, Job job);

/// The result document of a job with a solution.
void write_result_of(api::DocumentWriter& out, const JobWithResult& solved, const api::ResultFields& fields);

}  // namespace signorini::server
