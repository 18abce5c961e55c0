#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "result/solution.hpp"
#include "server/jobs/share.hpp"
#include "server/problem_details.hpp"

namespace signorini::server {

using Time = std::chrono::system_clock::time_point;

/// `2026-01-31T12:34:56.789Z`.
std::string iso8601(Time time);

/// Since 1970, as times are stored.
std::int64_t to_milliseconds(Time time);

enum class JobStatus { queued, running, succeeded, failed, cancelled };
inline constexpr std::array all_statuses{JobStatus::queued, JobStatus::running, JobStatus::succeeded,
                                         JobStatus::failed, JobStatus::cancelled};

/// The name of the status: `queued`, `running`, `succeeded`, `failed`, `cancelled`.
const char* name(JobStatus status);
std::optional<JobStatus> job_status(std::string_view name);
bool has_ended(JobStatus status);

/// The text with its ASCII letters in lower case.
std::string lower_case(std::string text);

/// How a job ended. There is a solution if any iterate was found, also when it did not converge; and an
/// error unless the job succeeded.
struct Ending {
  JobStatus status = JobStatus::failed;
  std::optional<ProblemDetails> error;
  std::shared_ptr<const Solution> solution;
  std::shared_ptr<const std::vector<Iteration>> history;  ///< what was iterated, solution or not
};

/// A job was cancelled while it waited, or while it ran in a process that then died.
Ending cancelled_ending(const std::string& detail);

/// What is stored of a job is not what was written: its `what`, such as `problem`.
Ending damaged_ending(const std::string& what);
bool is_damaged(const Ending& ending);

/// An ending without its fields: as much of it as a status document tells.
struct Verdict {
  std::optional<ProblemDetails> error;
  std::optional<Summary> summary;  ///< if there is a solution
  std::optional<Iteration> last_iteration;
};

Verdict verdict_of(const Ending& ending);

/// A job as it is accepted.
struct NewJob {
  std::string id;
  std::string title;
  std::vector<std::string> tags;
  Time created;
  std::shared_ptr<const std::string> problem;  ///< as the client sent it
  std::optional<std::string> key;  ///< by which the client tells a repeated request from a new one
  double predicted_memory = 0;     ///< bytes that its solve will take, about
  std::string trace;               ///< id of the trace of the request (W3C Trace Context); empty: none
  std::string owner;               ///< the name of who sent it; empty where there are no names
  Share share = {};                ///< of the owner
  std::string batch = {};          ///< id of the batch that it is of; empty: none
  std::int64_t operator_mark = 0;  ///< of the operator that its solve takes (kept_operators.hpp); 0: of none
};

/// Entries of the sweep of another job, which are solved as a job of their own.
struct Chunk {
  std::string whole;      ///< id of that job
  std::size_t first = 0;  ///< of the entries
  std::size_t count = 0;
};

/// One solve from its acceptance on, without the texts and the fields that belong to it.
struct Job {
  std::string id;
  JobStatus status = JobStatus::queued;
  std::string title;
  std::vector<std::string> tags;
  std::string trace;  ///< as in NewJob
  std::string owner;  ///< as in NewJob
  std::string batch;  ///< as in NewJob
  std::optional<Chunk> chunk = {};
  Time created;  ///< of a chunk: when the whole was started
  std::optional<Time> started;
  std::optional<Time> finished;
  Verdict verdict;  ///< once it has ended
};

/// A problem, and what a solve of it found out. Copies share the texts and the fields.
struct JobResult {
  std::shared_ptr<const std::string> problem;             ///< as the client sent it
  std::shared_ptr<const Solution> solution;               ///< null if there is none
  std::shared_ptr<const std::vector<Iteration>> history;  ///< null if nothing was iterated
};

/// About how much memory it holds.
std::size_t memory_of(const JobResult& result);

}  // namespace signorini::server
