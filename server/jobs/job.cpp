#include "server/jobs/job.hpp"

#include <array>
#include <cstdio>
#include <ctime>

namespace signorini::server {
namespace {

constexpr std::array status_names{"queued", "running", "succeeded", "failed", "cancelled"};

template <class Element>
std::size_t memory_of(const std::vector<Element>& elements) {
  return elements.capacity() * sizeof(Element);
}

std::size_t memory_of(const Eigen::MatrixXd& matrix) {
  return static_cast<std::size_t>(matrix.size()) * sizeof(double);
}

std::size_t memory_of(const ContactPart& part) {
  return memory_of(part.points) + memory_of(part.clearance) + memory_of(part.pressure) + memory_of(part.gap) +
         memory_of(part.weight) + part.open.capacity() / 8;
}

std::size_t memory_of(const Solution& solution) {
  std::size_t bytes = sizeof(Solution) + solution.mesh->bytes() + memory_of(solution.stress) +
                      memory_of(solution.displacement) + memory_of(solution.displacement_at_points) +
                      memory_of(solution.stress_at_centroids) + memory_of(solution.rotation) +
                      memory_of(solution.error_squares) + memory_of(solution.admissible_pressure) +
                      memory_of(solution.history);
  for (const ContactPart& part : solution.contact) bytes += memory_of(part);
  for (const SweepEntry& entry : solution.sweep) {
    bytes += sizeof(SweepEntry) + memory_of(entry.parts);
    for (const ContactPart& part : entry.contact) bytes += memory_of(part);
  }
  for (const LevelFields& level : solution.levels)
    bytes += sizeof(LevelFields) + memory_of(level.points) + memory_of(level.triangles) +
             memory_of(level.displacement_at_points) + memory_of(level.error_squares);
  return bytes + memory_of(solution.study);
}

}  // namespace

std::string iso8601(Time time) {
  using namespace std::chrono;
  const auto since_epoch = std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch());
  const std::time_t seconds_part = static_cast<std::time_t>(floor<seconds>(since_epoch).count());
  std::tm utc{};
  gmtime_r(&seconds_part, &utc);
  std::array<char, 32> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ",
                static_cast<int>(since_epoch.count() % 1000));
  return text.data();
}

std::int64_t to_milliseconds(Time time) {
  return std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

const char* name(JobStatus status) {
  return status_names.at(static_cast<std::size_t>(status));
}

std::optional<JobStatus> job_status(std::string_view name) {
  for (std::size_t i = 0; i < status_names.size(); ++i) {
    if (name == status_names[i]) return static_cast<JobStatus>(i);
  }
  return std::nullopt;
}

bool has_ended(JobStatus status) {
  return status != JobStatus::queued && status != JobStatus::running;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

Ending cancelled_ending(const std::string& detail) {
  Ending ending;
  ending.status = JobStatus::cancelled;
  ending.error = ProblemDetails{"cancelled", "The solve was cancelled", detail};
  return ending;
}

Ending damaged_ending(const std::string& what) {
  Ending ending;
  ending.error = ProblemDetails{"damaged", "What was stored of the solve is damaged",
                                "Its " + what +
                                    " in the data directory is not what was written there. Send the problem "
                                    "again; `signorinid check` with "
                                    "the directory (--data-dir) looks through all that is stored."};
  return ending;
}

bool is_damaged(const Ending& ending) {
  return ending.error && ending.error->kind == "damaged";
}

Verdict verdict_of(const Ending& ending) {
  Verdict verdict;
  verdict.error = ending.error;
  if (ending.solution) verdict.summary = ending.solution->summary;
  if (ending.history && !ending.history->empty()) verdict.last_iteration = ending.history->back();
  return verdict;
}

std::size_t memory_of(const JobResult& result) {
  std::size_t bytes = sizeof(JobResult);
  if (result.problem) bytes += result.problem->capacity();
  if (result.solution) {
    bytes += memory_of(*result.solution);
  } else if (result.history) {
    bytes += memory_of(*result.history);
  }
  return bytes;
}

}  // namespace signorini::server
