#include "server/jobs/sqlite_store.hpp"

#include <algorithm>
#include <cstring>

#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include "server/jobs/schema.hpp"
#include "server/jobs/stored_form.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

constexpr int attempts_allowed = 3;
constexpr int busy_timeout_ms = 5000;
constexpr std::size_t piece_bytes = std::size_t{64} << 20;

/// The columns that job_of() reads.
const std::string job_columns = "id, status, title, created, started, finished, verdict, trace";

// --- between SQLite's values and ours

struct Blob {
  const std::string_view bytes;
};

void bind(SQLite::Statement& statement, int index, const Blob& blob) {
  statement.bindNoCopy(index, blob.bytes.data(), static_cast<int>(blob.bytes.size()));
}

template <class Value>
void bind(SQLite::Statement& statement, int index, const Value& value) {
  statement.bind(index, value);
}

/// The statement with its values in the order of its question marks; blobs must outlive it.
template <class... Values>
SQLite::Statement prepared(const SQLite::Database& database, const std::string& sql,
                           const Values&... values) {
  SQLite::Statement statement(database, sql);
  int index = 0;
  (bind(statement, ++index, values), ...);
  return statement;
}

std::int64_t milliseconds(Time time) {
  return std::chrono::floor<std::chrono::milliseconds>(time.time_since_epoch()).count();
}

std::int64_t now() {
  return milliseconds(std::chrono::system_clock::now());
}

std::optional<Time> time_of(const SQLite::Column& column) {
  if (column.isNull()) return std::nullopt;
  return Time(std::chrono::milliseconds(column.getInt64()));
}

std::string bytes_of(const SQLite::Column& column) {
  return {static_cast<const char*>(column.getBlob()), static_cast<std::size_t>(column.getBytes())};
}

Job job_of(const SQLite::Statement& row) {
  Job job;
  job.id = row.getColumn(0).getString();
  job.status = job_status(row.getColumn(1).getString()).value();
  job.title = row.getColumn(2).getString();
  job.created = time_of(row.getColumn(3)).value();
  job.started = time_of(row.getColumn(4));
  job.finished = time_of(row.getColumn(5));
  if (!row.isColumnNull(6)) job.verdict = unpack_verdict(bytes_of(row.getColumn(6)));
  job.trace = row.getColumn(7).getString();
  return job;
}

std::shared_ptr<const std::string> problem_of(const SQLite::Database& database, const std::string& id) {
  auto row = prepared(database, "SELECT text FROM problems WHERE job = ?", id);
  if (!row.executeStep()) return nullptr;
  return std::make_shared<const std::string>(unpack_text(bytes_of(row.getColumn(0))));
}

// --- what can go wrong

/// In words, if it is the machine's fault and may pass; nothing if it is ours.
std::optional<std::string> passing_reason(const SQLite::Exception& error) {
  switch (error.getErrorCode()) {
    case SQLITE_FULL:
      return "the disk of the data directory is full";
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
      return "the data directory cannot be written: " + std::string(error.getErrorStr());
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "another program holds the database in the data directory";
    default:
      return std::nullopt;
  }
}

/// Inside a handler of the error.
[[noreturn]] void rethrow_as_unavailable(const SQLite::Exception& error) {
  if (const auto reason = passing_reason(error)) throw StoreUnavailable(*reason);
  throw;
}

SQLite::Database connect(const std::filesystem::path& file, const std::string& vfs) {
  try {
    SQLite::Database database(file.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, busy_timeout_ms,
                              vfs);
    database.exec(
        "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON;"
        "PRAGMA journal_size_limit = 67108864");
    return database;
  } catch (const SQLite::Exception& error) {
    throw CannotOpenStore("cannot open the jobs in " + file.string() + ": " + error.getErrorStr() +
                          " (--data-dir)");
  }
}

Ending attempts_used_up() {
  Ending ending;
  ending.status = JobStatus::failed;
  ending.error = ProblemDetails{
      "attempts-used-up", "The service died while it solved the problem",
      "It died " + std::to_string(attempts_allowed) +
          " times while this solve ran, and does not try it again. Most often the machine has too little "
          "memory for it (POST /v1/validate estimates it): take a coarser mesh or fewer workers."};
  return ending;
}

}  // namespace

// --- the two ways into the database

/// Runs the step as one transaction.
template <class Step>
auto SqliteStore::write(const Step& step) {
  const std::lock_guard lock(writing_);
  const std::int64_t bytes_before = ended_bytes_;
  try {
    SQLite::Transaction transaction(writer_, SQLite::TransactionBehavior::IMMEDIATE);
    auto result = step();
    transaction.commit();
    const std::lock_guard noting(trouble_mutex_);
    if (std::exchange(trouble_, std::nullopt)) spdlog::info("the data directory can be written again");
    return result;
  } catch (const SQLite::Exception& error) {
    ended_bytes_ = bytes_before;
    if (const auto reason = passing_reason(error)) {
      const std::lock_guard noting(trouble_mutex_);
      if (!trouble_) spdlog::error("{}", *reason);
      trouble_ = reason;
    }
    rethrow_as_unavailable(error);
  } catch (...) {
    ended_bytes_ = bytes_before;
    throw;
  }
}

template <class Step>
auto SqliteStore::read(const Step& step) const {
  const std::lock_guard lock(reading_);
  try {
    return step();
  } catch (const SQLite::Exception& error) {
    rethrow_as_unavailable(error);
  }
}

// --- the life of a job

SqliteStore::SqliteStore(const std::filesystem::path& directory, const StoreLimits& limits,
                         const std::string& vfs)
    : limits_(limits),
      directory_(directory),
      vfs_(vfs),
      writer_(connect(directory_.database(), vfs_)),
      reader_(connect(directory_.database(), vfs_)) {
  try {
    migrate(writer_);
    recover();
  } catch (const std::runtime_error& error) {
    throw CannotOpenStore("cannot open the jobs in " + directory.string() + ": " + error.what());
  }
}

std::string SqliteStore::add(NewJob job) {
  const std::string packed = pack_text(*job.problem);
  return write([&]() -> std::string {
    if (job.key) {
      if (const auto earlier = job_with_key(*job.key, *job.problem)) return *earlier;
    }
    const auto queued = writer_.execAndGet("SELECT count(*) FROM jobs WHERE status = 'queued'").getInt64();
    if (static_cast<std::size_t>(queued) >= limits_.queue) throw QueueFull(limits_.queue);
    prepared(writer_,
             "INSERT INTO jobs (id, status, title, created, bytes, trace) VALUES (?, 'queued', ?, ?, ?, ?)",
             job.id, job.title, milliseconds(job.created), static_cast<std::int64_t>(packed.size()), job.trace)
        .exec();
    prepared(writer_, "INSERT INTO problems VALUES (?, ?)", job.id, Blob{packed}).exec();
    if (job.key) prepared(writer_, "INSERT INTO idempotency_keys VALUES (?, ?)", *job.key, job.id).exec();
    return job.id;
  });
}

std::optional<std::string> SqliteStore::job_with_key(const std::string& key, const std::string& problem) {
  auto row = prepared(writer_, "SELECT job FROM idempotency_keys WHERE key = ?", key);
  if (!row.executeStep()) return std::nullopt;
  const std::string id = row.getColumn(0).getString();
  if (*problem_of(writer_, id) != problem) throw KeyReused(id);
  return id;
}

std::optional<Claim> SqliteStore::claim() {
  return write([&]() -> std::optional<Claim> {
    auto row = prepared(writer_,
                        "UPDATE jobs SET status = 'running', started = ?, attempt = attempt + 1 WHERE id = "
                        "(SELECT min(id) FROM jobs WHERE status = 'queued') "
                        "RETURNING " +
                            job_columns + ", attempt",
                        now());
    if (!row.executeStep()) return std::nullopt;
    Job job = job_of(row);
    const auto problem = problem_of(writer_, job.id);
    return Claim{std::move(job), problem, static_cast<std::uint64_t>(row.getColumn(8).getInt64())};
  });
}

bool SqliteStore::finish(const Claim& claim, const Ending& ending) {
  const std::string findings = pack_findings(ending);
  return write([&] {
    return end(claim.job.id, "status = 'running' AND attempt = " + std::to_string(claim.attempt), ending,
               findings);
  });
}

bool SqliteStore::give_back(const Claim& claim) {
  return write([&] {
    return prepared(writer_,
                    "UPDATE jobs SET status = 'queued', started = NULL, given_back = given_back + 1 "
                    "WHERE id = ? AND attempt = ? AND status = 'running' AND NOT cancel_asked",
                    claim.job.id, static_cast<std::int64_t>(claim.attempt))
               .exec() == 1;
  });
}

Cancellation SqliteStore::cancel(const std::string& id) {
  const Ending cancelled = cancelled_ending("The solve was cancelled before it began.");
  return write([&] {
    if (end(id, "status = 'queued'", cancelled, {})) return Cancellation::ended;
    const bool runs =
        prepared(writer_, "UPDATE jobs SET cancel_asked = 1 WHERE id = ? AND status = 'running'", id)
            .exec() == 1;
    return runs ? Cancellation::asked : Cancellation::none;
  });
}

bool SqliteStore::remove_ended(const std::string& id) {
  return write([&] {
    auto row =
        prepared(writer_, "DELETE FROM jobs WHERE id = ? AND finished IS NOT NULL RETURNING bytes", id);
    if (!row.executeStep()) return false;
    ended_bytes_ -= row.getColumn(0).getInt64();
    return true;
  });
}

/// Within a step: ends the job if the condition on its row holds, and keeps what was found out.
bool SqliteStore::end(const std::string& id, const std::string& condition, const Ending& ending,
                      const std::string& findings) {
  const std::string verdict = pack_verdict(verdict_of(ending));
  {
    auto row = prepared(writer_,
                        "UPDATE jobs SET status = ?, finished = ?, verdict = ?, bytes = bytes + ? "
                        "WHERE id = ? AND " +
                            condition + " RETURNING bytes",
                        std::string(name(ending.status)), now(), Blob{verdict},
                        static_cast<std::int64_t>(findings.size()), id);
    if (!row.executeStep()) return false;
    ended_bytes_ += row.getColumn(0).getInt64();
  }
  const std::string_view rest = findings;
  for (std::size_t begin = 0; begin < rest.size(); begin += piece_bytes) {
    prepared(writer_, "INSERT INTO results VALUES (?, ?, ?)", id,
             static_cast<std::int64_t>(begin / piece_bytes), Blob{rest.substr(begin, piece_bytes)})
        .exec();
  }
  drop_beyond_limits();
  return true;
}

void SqliteStore::drop_expired() {
  write([&] {
    drop_beyond_limits();
    return true;
  });
}

/// Within a step, which should stay short: what is left over goes with the next one.
void SqliteStore::drop_beyond_limits() {
  constexpr int most_at_once = 1000;
  const std::int64_t oldest = milliseconds(std::chrono::system_clock::now() - limits_.keep);
  for (int i = 0; i < most_at_once; ++i) {
    auto row = prepared(writer_,
                        "SELECT id, finished, bytes FROM jobs WHERE finished IS NOT NULL "
                        "ORDER BY finished, id LIMIT 2");
    if (!row.executeStep()) return;
    const std::string id = row.getColumn(0).getString();
    const bool expired = row.getColumn(1).getInt64() < oldest;
    const std::int64_t bytes = row.getColumn(2).getInt64();
    const bool last = !row.executeStep();
    if (!expired && (last || ended_bytes_ <= static_cast<std::int64_t>(limits_.keep_bytes))) return;
    prepared(writer_, "DELETE FROM jobs WHERE id = ?", id).exec();
    ended_bytes_ -= bytes;
    const LogField job("job", id);
    spdlog::info("dropped bytes={} kept_bytes={} ({})", bytes, ended_bytes_,
                 expired ? "--keep-seconds" : "--keep-bytes");
  }
}

/// The process that left these jobs as running is dead: nobody else has the directory.
void SqliteStore::recover() {
  write([&] {
    ended_bytes_ =
        writer_.execAndGet("SELECT ifnull(sum(bytes), 0) FROM jobs WHERE finished IS NOT NULL").getInt64();
    std::vector<std::pair<std::string, Ending>> over;
    {
      auto row = prepared(writer_,
                          "SELECT id, cancel_asked FROM jobs WHERE status = 'running' "
                          "AND (cancel_asked OR attempt - given_back >= ?)",
                          attempts_allowed);
      while (row.executeStep()) {
        over.emplace_back(row.getColumn(0).getString(),
                          row.getColumn(1).getInt() != 0
                              ? cancelled_ending("The solve was cancelled before it ended.")
                              : attempts_used_up());
      }
    }
    for (const auto& [id, ending] : over) {
      end(id, "status = 'running'", ending, {});
      const LogField job("job", id);
      spdlog::warn("{} kind={}", name(ending.status), ending.error->kind);
    }
    const int again =
        writer_.exec("UPDATE jobs SET status = 'queued', started = NULL WHERE status = 'running'");
    if (again > 0) spdlog::warn("{} solves ran when the service died; they are queued again", again);
    return true;
  });
}

// --- readers

std::optional<Job> SqliteStore::find(const std::string& id) const {
  return read([&]() -> std::optional<Job> {
    auto row = prepared(reader_, "SELECT " + job_columns + " FROM jobs WHERE id = ?", id);
    if (!row.executeStep()) return std::nullopt;
    return job_of(row);
  });
}

JobPage SqliteStore::list(const ListQuery& query) const {
  std::string sql = "SELECT " + job_columns + " FROM jobs WHERE id < ?";
  if (query.status) sql += " AND status = '" + std::string(name(*query.status)) + "'";
  sql += " ORDER BY id DESC LIMIT ?";
  const std::string beyond_every_id = "~";
  return read([&] {
    JobPage page;
    auto row = prepared(reader_, sql, query.after.value_or(beyond_every_id),
                        static_cast<std::int64_t>(query.limit) + 1);
    while (row.executeStep()) page.jobs.push_back(job_of(row));
    page.more = page.jobs.size() > query.limit;
    if (page.more) page.jobs.pop_back();
    return page;
  });
}

JobCounts SqliteStore::count() const {
  return read([&] {
    JobCounts counts;
    auto row = prepared(reader_, "SELECT status, count(*) FROM jobs GROUP BY status");
    while (row.executeStep())
      counts[job_status(row.getColumn(0).getString()).value()] =
          static_cast<std::size_t>(row.getColumn(1).getInt64());
    return counts;
  });
}

std::optional<JobResult> SqliteStore::result(const std::string& id) const {
  JobResult result;
  std::string findings;
  try {
    SQLite::Database connection(directory_.database().string(), SQLite::OPEN_READWRITE, busy_timeout_ms,
                                vfs_);
    // Both from one state of the database.
    const SQLite::Transaction transaction(connection);
    result.problem = problem_of(connection, id);
    if (!result.problem) return std::nullopt;
    auto row = prepared(connection, "SELECT bytes FROM results WHERE job = ? ORDER BY piece", id);
    while (row.executeStep()) findings += bytes_of(row.getColumn(0));
  } catch (const SQLite::Exception& error) {
    rethrow_as_unavailable(error);
  }
  if (!findings.empty()) unpack_findings(findings, result);
  return result;
}

std::optional<std::string> SqliteStore::trouble() {
  {
    const std::lock_guard lock(trouble_mutex_);
    if (!trouble_) return std::nullopt;
  }
  try {
    write([&] {
      // Writes the first page, as it is.
      writer_.exec("PRAGMA user_version = " + std::to_string(schema_version()));
      return true;
    });
    return std::nullopt;
  } catch (const StoreUnavailable& unavailable) {
    return unavailable.what();
  }
}

}  // namespace signorini::server
