#include "server/jobs/sqlite/job_rows.hpp"

#include <stdexcept>

#include "server/jobs/stored_form.hpp"

namespace signorini::server {
namespace {

const std::string first_columns =
    "id, status, title, created, started, finished, attempt, given_back, cancel_asked, verdict, bytes, "
    "trace, "
    "owner, ended, damaged";

/// One without what came later is sealed as it was before that.
const std::string seal = "CASE WHEN batch <> '' THEN row_seal(" + first_columns +
                         ", tags, batch) WHEN tags <> '' THEN row_seal(" + first_columns +
                         ", tags) ELSE row_seal(" + first_columns + ") END";

const std::string what_is_a_row = "entry in the list of solves";

Job damaged_job(std::string id, std::string owner) {
  Job job;
  job.id = std::move(id);
  job.owner = std::move(owner);
  job.status = JobStatus::failed;
  job.verdict = verdict_of(damaged_ending(what_is_a_row));
  return job;
}

}  // namespace

const std::string is_intact = "seal IS NULL OR seal = (" + seal + ")";

const std::string job_columns =
    "id, status, title, created, started, finished, verdict, trace, owner, tags, batch, " + is_intact;

void seal_changes(SQLite::Database& database) {
  const std::string renew = "BEGIN UPDATE jobs SET seal = (" + seal + ") WHERE id = NEW.id; END;";
  database.exec("CREATE TEMP TRIGGER seal_new AFTER INSERT ON main.jobs " + renew +
                "CREATE TEMP TRIGGER seal_changed AFTER UPDATE OF status, title, created, started, finished, "
                "attempt, given_back, cancel_asked, verdict, bytes, trace, owner, ended, damaged, tags, "
                "batch ON main.jobs " +
                renew);
}

Job job_of(const SQLite::Statement& row) {
  Job job;
  job.id = row.getColumn(0).getString();
  job.owner = row.getColumn(8).getString();
  const std::optional<JobStatus> status = job_status(row.getColumn(1).getString());
  if (!status || row.getColumn(11).getInt() == 0) return damaged_job(job.id, job.owner);
  job.status = *status;
  job.title = row.getColumn(2).getString();
  job.created = time_of(row.getColumn(3)).value_or(Time());
  job.started = time_of(row.getColumn(4));
  job.finished = time_of(row.getColumn(5));
  job.trace = row.getColumn(7).getString();
  job.batch = row.getColumn(10).getString();
  try {
    job.tags = unpack_list(row.getColumn(9).getString());
    if (!row.isColumnNull(6)) job.verdict = unpack_verdict(bytes_of(row.getColumn(6)));
  } catch (const std::exception&) {
    return damaged_job(job.id, job.owner);
  }
  return job;
}

const std::string batch_columns = "id, owner, created, content";

std::optional<Batch> batch_of(const SQLite::Statement& row) try {
  Batch batch;
  batch.id = row.getColumn(0).getString();
  batch.owner = row.getColumn(1).getString();
  batch.created = time_of(row.getColumn(2)).value_or(Time());
  unpack_content(bytes_of(row.getColumn(3)), batch);
  return batch;
} catch (const std::exception&) {
  return std::nullopt;
}

std::shared_ptr<const std::string> problem_of(const Database& database, const std::string& id) {
  try {
    auto row = prepared(database, "SELECT text FROM problems WHERE job = ?", id);
    if (!row.executeStep()) return nullptr;
    return std::make_shared<const std::string>(unpack_text(bytes_of(row.getColumn(0))));
  } catch (const SQLite::Exception& error) {
    if (is_damage(error)) return nullptr;
    throw;
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

void fail_as_damaged(Database& database, const std::string& id, const std::string& what,
                     std::int64_t retention) {
  const std::int64_t now = to_milliseconds(std::chrono::system_clock::now());
  // What a row says that is not intact may be anything: a size that would push everything else out, an age.
  prepared(
      database,
      "UPDATE jobs SET title = '', created = ?, started = NULL, finished = NULL, ended = NULL, bytes = 0, "
      "attempt = 0, given_back = 0, trace = '', tags = '' WHERE id = ? AND NOT (" +
          is_intact + ")",
      now, id)
      .exec();
  const std::string verdict = pack_verdict(verdict_of(damaged_ending(what)));
  prepared(database,
           "UPDATE jobs SET status = 'failed', finished = ifnull(finished, ?), ended = ifnull(ended, ?), "
           "verdict = ?, damaged = 1 WHERE id = ?",
           now, retention, Blob{verdict}, id)
      .exec();
  database.exec(
      "UPDATE state SET ended_bytes = (SELECT ifnull(sum(bytes), 0) FROM jobs WHERE ended IS NOT NULL)");
}

}  // namespace signorini::server
