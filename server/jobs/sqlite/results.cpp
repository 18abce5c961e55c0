// How results are read, which may be damaged.

#include "server/jobs/sqlite/store.hpp"

#include <functional>

#include <spdlog/spdlog.h>

#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/result_bytes.hpp"
#include "server/jobs/sqlite/steps.hpp"
#include "server/jobs/stored_form.hpp"
#include "server/log.hpp"

namespace signorini::server {

std::optional<JobResult> SqliteStore::result(const std::string& id) {
  const std::optional<Job> job = find(id);
  if (!job) return std::nullopt;
  const bool has_result = job->verdict.summary || job->verdict.last_iteration;
  JobResult result;
  const char* damaged = nullptr;
  try {
    Database connection = connect_to_read(directory_.database(), vfs_);
    // Both from one state of the database.
    const SQLite::Transaction transaction(connection);
    result.problem = problem_of(connection, id);
    ResultBytes bytes(connection, id);
    if (!result.problem) {
      damaged = "problem";
    } else if (bytes.size() > 0) {
      unpack_findings(std::bind_front(&ResultBytes::read, &bytes), result);
    } else if (has_result) {
      damaged = "result";
    }
  } catch (const SQLite::Exception& error) {
    if (!is_damage(error)) rethrow_as_unavailable(error);
    damaged = "result";
  } catch (const std::runtime_error&) {
    damaged = "result";
  }
  return damaged != nullptr ? damaged_result(id, damaged) : result;
}

std::size_t SqliteStore::result_memory(const std::string& id) const {
  return read([&]() -> std::size_t {
    ResultBytes bytes(reader_, id);
    if (bytes.size() == 0) return 0;
    try {
      return unpacked_size(std::bind_front(&ResultBytes::read, &bytes));
    } catch (const SQLite::Exception&) {
      throw;
    } catch (const std::runtime_error&) {
      return 0;  // the result will turn out to be damaged
    }
  });
}

/// Nothing if the job was removed meanwhile.
std::optional<JobResult> SqliteStore::damaged_result(const std::string& id, const std::string& what) {
  const bool there = write([&] {
    auto row = prepared(writer_, "SELECT ended IS NOT NULL, damaged FROM jobs WHERE id = ?", id);
    if (!row.executeStep()) return false;
    const bool ended = row.getColumn(0).getInt() != 0, known = row.getColumn(1).getInt() != 0;
    row.reset();
    // A worker that has it finds out by itself.
    if (!ended || known) return true;
    fail_as_damaged(writer_, id, what, clock_.now());
    const LogField job("job", id);
    spdlog::error("failed kind=damaged: its {} is not what was written", what);
    return true;
  });
  if (!there) return std::nullopt;
  return JobResult{std::make_shared<const std::string>("null"), nullptr, nullptr};
}

std::size_t SqliteStore::damaged() const {
  return read([&] {
    return static_cast<std::size_t>(reader_.execAndGet("SELECT count(*) FROM jobs WHERE damaged").getInt64());
  });
}

}  // namespace signorini::server
