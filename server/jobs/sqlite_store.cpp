#include "server/jobs/sqlite_store.hpp"

#include <algorithm>
#include <cstdlib>
#include <functional>

#include <spdlog/spdlog.h>
#include <sqlite3.h>

#include "server/jobs/file_limit.hpp"
#include "server/jobs/job_rows.hpp"
#include "server/jobs/repair.hpp"
#include "server/jobs/result_bytes.hpp"
#include "server/jobs/schema.hpp"
#include "server/jobs/stored_form.hpp"
#include "server/log.hpp"

namespace signorini::server {
namespace {

constexpr int attempts_allowed = 3;
/// SQLite copies each as it writes it.
constexpr std::size_t piece_bytes = std::size_t{4} << 20;
constexpr const char* disk_is_full = "the disk of the data directory is full";

// --- what can go wrong

/// What frees room may use the reserve then.
class DiskFull : public StoreUnavailable {
 public:
  DiskFull() : StoreUnavailable(disk_is_full) {}
};

std::string damage_in_words(const SQLite::Exception& error) {
  return "the database in the data directory is damaged (" + std::string(error.getErrorStr()) +
         "): start the service again, which repairs it, or stop it and run `signorinid check` with the "
         "directory";
}

/// Inside a handler of the error.
[[noreturn]] void rethrow_as_unavailable(const SQLite::Exception& error) {
  if (error.getErrorCode() == SQLITE_FULL) throw DiskFull();
  if (const auto reason = passing_reason(error)) throw StoreUnavailable(*reason);
  if (is_damage(error)) throw StoreUnavailable(damage_in_words(error));
  throw;
}

void repair_if_damaged(const DataDir& directory, const std::string& vfs) {
  if (!std::filesystem::exists(directory.database())) return;
  for (const std::string& damage : repair(directory, Depth::rows, vfs).damage)
    spdlog::error("the data directory was damaged: {}", damage);
}

/// A database that an older version made gives no room back; all of it is written anew, once.
void give_room_back(SQLite::Database& database) {
  constexpr int incremental = 2;
  if (database.execAndGet("PRAGMA auto_vacuum").getInt() == incremental) return;
  spdlog::info("the database is written anew, so that its file can shrink from now on");
  database.exec("PRAGMA auto_vacuum = INCREMENTAL; VACUUM");
}

/// What a killed service has left needs room to be opened.
Database open_jobs(const DataDir& directory, const std::string& vfs, DiskReserve& reserve) {
  if (!reserve.room()) reserve.spend();
  repair_if_damaged(directory, vfs);
  try {
    Database database = connect(directory.database(), vfs);
    migrate(database);
    give_room_back(database);
    seal_changes(database);
    return database;
  } catch (const SQLite::Exception& error) {
    throw CannotOpenStore("cannot open the jobs in " + directory.database().string() + ": " +
                          error.getErrorStr() + " (--data-dir)");
  }
}

std::optional<KeptClock> kept_clock(const Database& database) {
  auto row = prepared(database, "SELECT retention, wall FROM state");
  if (!row.executeStep()) return std::nullopt;
  return KeptClock{row.getColumn(0).getInt64(), row.getColumn(1).getInt64()};
}

/// Ids of jobs, newest first, among which are those that are asked for: of a tag where tags are sorted, of a
/// title in an index of nothing but titles. Empty: all.
std::string candidates(const ListQuery& query) {
  const std::string of_owner = query.owner ? " AND owner = :owner" : "";
  if (query.tag)
    return "SELECT job AS candidate FROM job_tags WHERE tag = :tag AND job >= :oldest AND job < :after" +
           of_owner;
  if (query.title)
    return "SELECT id AS candidate FROM jobs INDEXED BY jobs_by_title WHERE id >= :oldest AND id < :after "
           "AND "
           "instr(lower(title), :title)" +
           of_owner;
  return "";
}

const std::string before_every_id, beyond_every_id = "~";

/// The oldest job of which a page reads the title, if there may be older ones.
std::optional<std::string> oldest_read(const Database& database, const ListQuery& query) {
  if (!query.title) return std::nullopt;
  auto row = prepared(
      database, "SELECT id FROM jobs INDEXED BY jobs_by_title WHERE id < ? ORDER BY id DESC LIMIT 1 OFFSET ?",
      query.after.value_or(beyond_every_id), static_cast<std::int64_t>(titles_of_a_page) - 1);
  if (!row.executeStep()) return std::nullopt;
  return row.getColumn(0).getString();
}

/// The columns of all jobs that are asked for, newest first; none is older than the oldest.
SQLite::Statement selection(const Database& database, const std::string& columns, const ListQuery& query,
                            const std::string& oldest, std::int64_t limit) {
  const std::string first = candidates(query);
  std::string sql = "SELECT " + columns + " FROM ";
  sql += first.empty() ? "jobs" : "(" + first + ") CROSS JOIN jobs ON id = candidate";
  sql += " WHERE id >= :oldest AND id < :after";
  if (query.status) sql += " AND status = '" + std::string(name(*query.status)) + "'";
  if (query.owner) sql += " AND jobs.owner = :owner";
  if (query.title) sql += " AND instr(lower(title), :title)";
  sql += std::string(" ORDER BY ") + (first.empty() ? "id" : "candidate") + " DESC LIMIT :limit";
  SQLite::Statement row(database, sql);
  row.bind(":oldest", oldest);
  row.bind(":after", query.after.value_or(beyond_every_id));
  row.bind(":limit", limit);
  if (query.owner) row.bind(":owner", *query.owner);
  if (query.title) row.bind(":title", lower_case(*query.title));
  if (query.tag) row.bind(":tag", query.tag->data(), static_cast<int>(query.tag->size()));
  return row;
}

JobCounts counts_in(SQLite::Statement& row) {
  JobCounts counts;
  while (row.executeStep()) {
    // One that no job can have is told of as failed.
    const auto status = job_status(row.getColumn(0).getString()).value_or(JobStatus::failed);
    counts[status] += static_cast<std::size_t>(row.getColumn(1).getInt64());
  }
  return counts;
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

/// Runs the step as one transaction, or as a part of one.
template <class Step>
auto SqliteStore::write(const Step& step, Survives survives) {
  std::optional<std::invoke_result_t<Step>> result;
  try {
    commits_.run([&] { result = step(); }, survives);
  } catch (const SQLite::Exception& error) {
    note_trouble(error);
    rethrow_as_unavailable(error);
  }
  return *std::move(result);
}

/// The same for a step after which there is more room.
template <class Step>
auto SqliteStore::write_what_frees(const Step& step) {
  try {
    return write(step);
  } catch (const DiskFull&) {
    const std::lock_guard lock(trouble_mutex_);
    reserve_.spend();
  }
  auto result = write(step);
  shrink();
  return result;
}

template <class Step>
auto SqliteStore::read(const Step& step) const {
  const std::lock_guard lock(reading_);
  try {
    return step();
  } catch (const SQLite::Exception& error) {
    if (is_damage(error)) note_trouble(error);
    rethrow_as_unavailable(error);
  }
}

void SqliteStore::note_trouble(const SQLite::Exception& error) const {
  const std::lock_guard lock(trouble_mutex_);
  if (is_damage(error)) {
    if (!damage_) spdlog::error("{}", damage_in_words(error));
    damage_ = damage_in_words(error);
  } else if (const auto reason = passing_reason(error)) {
    if (!trouble_) spdlog::error("{}", *reason);
    trouble_ = reason;
  }
}

// --- the life of a job

SqliteStore::SqliteStore(const std::filesystem::path& directory, const StoreLimits& limits,
                         const std::string& vfs)
    : limits_(limits),
      directory_(directory),
      vfs_(vfs),
      reserve_(directory_.reserve()),
      writer_(open_jobs(directory_, vfs_, reserve_)),
      reader_(connect(directory_.database(), vfs_)) {
  try {
    recover();
  } catch (const std::runtime_error& error) {
    throw CannotOpenStore("cannot open the jobs in " + directory.string() + ": " + error.what());
  }
}

std::string SqliteStore::add(NewJob job) {
  require_room();
  const std::string packed = pack_text(*job.problem);
  return write([&]() -> std::string {
    if (job.key) {
      if (const auto earlier = job_with_key(writer_, job.owner, *job.key, *job.problem)) return *earlier;
    }
    require_places(1, job.owner, job.share);
    insert(job, packed);
    return job.id;
  });
}

Batch SqliteStore::add(NewBatch batch) {
  require_room();
  std::vector<std::string> packed;
  std::size_t bytes = 0;
  for (const NewJob& job : batch.jobs) bytes += packed.emplace_back(pack_text(*job.problem)).size();
  require_growth(bytes);
  const std::string content = pack_content(batch.batch);
  return write([&]() -> Batch {
    const auto& [id, title, tags, owner, created, jobs] = batch.batch;
    if (batch.key) {
      if (auto earlier = batch_with_key(writer_, owner, *batch.key, batch.digest)) return *std::move(earlier);
    }
    require_places(batch.jobs.size(), owner, batch.jobs.front().share);
    auto row = prepared(writer_, "INSERT INTO batches VALUES (?, ?, ?, ?, ?, ?)", id, owner,
                        to_milliseconds(created), batch.key.value_or(""), batch.digest, Blob{content});
    if (!batch.key) row.bind(4);
    row.exec();
    for (std::size_t i = 0; i < batch.jobs.size(); ++i) insert(batch.jobs[i], packed[i]);
    return batch.batch;
  });
}

/// Within a step: throws QueueFull if no request more may wait, or not so many jobs of the owner.
void SqliteStore::require_places(std::size_t jobs, const std::string& owner, const Share& share) {
  const auto count = [](Prepared row) {
    row.executeStep();
    return static_cast<std::size_t>(row.getColumn(0).getInt64());
  };
  const char* const requests =
      "SELECT count(DISTINCT iif(batch = '', id, batch)) FROM jobs WHERE status = 'queued'";
  if (count(prepared(writer_, requests)) >= limits_.queue) throw QueueFull(limits_.queue);
  const char* const of_owner = "SELECT count(*) FROM jobs WHERE status = 'queued' AND owner = ?";
  if (share.queue && count(prepared(writer_, of_owner, owner)) + jobs > *share.queue)
    throw QueueFull(*share.queue, true);
}

/// Within a step.
void SqliteStore::insert(const NewJob& job, const std::string& packed_problem) {
  prepared(writer_,
           "INSERT INTO jobs (id, status, title, created, bytes, trace, owner, tags, batch) "
           "VALUES (?, 'queued', ?, ?, ?, ?, ?, ?, ?)",
           job.id, job.title, to_milliseconds(job.created), static_cast<std::int64_t>(packed_problem.size()),
           job.trace, job.owner, pack_list(job.tags), job.batch)
      .exec();
  prepared(writer_, "INSERT INTO problems VALUES (?, ?)", job.id, Blob{packed_problem}).exec();
  if (job.key)
    prepared(writer_, "INSERT INTO idempotency_keys VALUES (?, ?, ?)", job.owner, *job.key, job.id).exec();
}

std::optional<std::string> SqliteStore::earlier(const std::string& owner, const std::string& key,
                                                const std::string& problem) {
  return read([&] { return job_with_key(reader_, owner, key, problem); });
}

std::optional<std::string> SqliteStore::job_with_key(const Database& database, const std::string& owner,
                                                     const std::string& key,
                                                     const std::string& problem) const {
  auto batch = prepared(database, "SELECT id FROM batches WHERE owner = ? AND key = ?", owner, key);
  if (batch.executeStep()) throw KeyReused(batch.getColumn(0).getString(), true);
  auto row = prepared(database, "SELECT job FROM idempotency_keys WHERE owner = ? AND key = ?", owner, key);
  if (!row.executeStep()) return std::nullopt;
  const std::string id = row.getColumn(0).getString();
  const auto known = problem_of(database, id);
  if (known && *known != problem) throw KeyReused(id);
  return id;
}

std::optional<Batch> SqliteStore::earlier_batch(const std::string& owner, const std::string& key,
                                                const std::string& digest) {
  return read([&] { return batch_with_key(reader_, owner, key, digest); });
}

std::optional<Batch> SqliteStore::batch_with_key(const Database& database, const std::string& owner,
                                                 const std::string& key, const std::string& digest) const {
  auto job = prepared(database, "SELECT job FROM idempotency_keys WHERE owner = ? AND key = ?", owner, key);
  if (job.executeStep()) throw KeyReused(job.getColumn(0).getString());
  auto row = prepared(
      database, "SELECT " + batch_columns + ", digest FROM batches WHERE owner = ? AND key = ?", owner, key);
  if (!row.executeStep()) return std::nullopt;
  if (row.getColumn(4).getString() != digest) throw KeyReused(row.getColumn(0).getString(), true);
  return batch_of(row);
}

std::optional<Claim> SqliteStore::claim() {
  const auto step = [&]() -> std::optional<Claim> {
    for (;;) {
      Job job;
      std::int64_t attempt = 0;
      {
        auto row = prepared(writer_, "SELECT " + job_columns +
                                         ", attempt FROM jobs WHERE status = 'queued' ORDER BY id LIMIT 1");
        if (!row.executeStep()) return std::nullopt;
        job = job_of(row);
        attempt = row.getColumn(job_column_count).getInt64() + 1;
      }
      if (job.status != JobStatus::queued) {
        fail_as_damaged(writer_, job.id, "entry in the list of solves", clock_.now());
        continue;
      }
      job.status = JobStatus::running;
      job.started = std::chrono::system_clock::now();
      prepared(writer_, "UPDATE jobs SET status = 'running', started = ?, attempt = ? WHERE id = ?",
               to_milliseconds(*job.started), attempt, job.id)
          .exec();
      const auto problem = problem_of(writer_, job.id);
      return Claim{std::move(job), problem, static_cast<std::uint64_t>(attempt)};
    }
  };
  return write(step, Survives::process);
}

bool SqliteStore::finish(const Claim& claim, const Ending& ending) {
  const std::string findings = pack_findings(ending);
  require_growth(findings.size());
  return write([&] { return end(claim.job.id, JobStatus::running, claim.attempt, ending, findings); });
}

/// Throws StoreUnavailable if a result so long would leave too little of what files may grow by: where the
/// log cannot grow, not even a deletion can be written. The end of a job without a result is always let
/// through.
void SqliteStore::require_growth(std::size_t bytes) const {
  if (bytes == 0) return;
  if (const auto limit = limit_of_growth(directory_.database(), bytes + DiskReserve::bytes / 2))
    throw StoreUnavailable(*limit);
}

bool SqliteStore::give_back(const Claim& claim) {
  const auto step = [&] {
    return prepared(writer_,
                    "UPDATE jobs SET status = 'queued', started = NULL, given_back = given_back + 1 "
                    "WHERE id = ? AND attempt = ? AND status = 'running' AND NOT cancel_asked",
                    claim.job.id, static_cast<std::int64_t>(claim.attempt))
               .exec() == 1;
  };
  return write(step, Survives::process);
}

Cancellation SqliteStore::cancel(const std::string& id) {
  const Ending cancelled = cancelled_ending("The solve was cancelled before it began.");
  return write_what_frees([&] {
    if (end(id, JobStatus::queued, std::nullopt, cancelled, {})) return Cancellation::ended;
    const bool runs =
        prepared(writer_, "UPDATE jobs SET cancel_asked = 1 WHERE id = ? AND status = 'running'", id)
            .exec() == 1;
    return runs ? Cancellation::asked : Cancellation::none;
  });
}

bool SqliteStore::remove_ended(const std::string& id) {
  return remove_ended(std::span(&id, 1)) == 1;
}

std::size_t SqliteStore::remove_ended(std::span<const std::string> ids) {
  return write_what_frees([&] {
    std::size_t removed = 0;
    for (const std::string& id : ids) {
      auto row = prepared(writer_, "DELETE FROM jobs WHERE id = ? AND ended IS NOT NULL RETURNING bytes", id);
      if (!row.executeStep()) continue;
      prepared(writer_, "UPDATE state SET ended_bytes = ended_bytes - ?", row.getColumn(0).getInt64()).exec();
      ++removed;
    }
    return removed;
  });
}

/// Within a step: ends the job if it has this status, in this attempt if one is named, and keeps what was
/// found out.
bool SqliteStore::end(const std::string& id, JobStatus status, std::optional<std::uint64_t> attempt,
                      const Ending& ending, const std::string& findings) {
  const std::string verdict = pack_verdict(verdict_of(ending));
  const KeptClock clock = clock_.reading();
  std::int64_t bytes = 0;
  {
    auto row =
        prepared(writer_,
                 "UPDATE jobs SET status = ?, finished = ?, ended = ?, verdict = ?, bytes = bytes + ?, "
                 "damaged = ? WHERE id = ? AND status = ? AND attempt = ifnull(?, attempt) RETURNING bytes",
                 std::string(name(ending.status)), clock.wall, clock.retention, Blob{verdict},
                 static_cast<std::int64_t>(findings.size()), static_cast<int>(is_damaged(ending)), id,
                 std::string(name(status)));
    constexpr int of_attempt = 9;
    if (attempt) row.bind(of_attempt, static_cast<std::int64_t>(*attempt));
    if (!row.executeStep()) return false;
    bytes = row.getColumn(0).getInt64();
  }
  prepared(writer_, "UPDATE state SET ended_bytes = ended_bytes + ?, retention = ?, wall = ?", bytes,
           clock.retention, clock.wall)
      .exec();
  const std::string_view rest = findings;
  for (std::size_t begin = 0; begin < rest.size(); begin += piece_bytes) {
    prepared(writer_, "INSERT INTO results VALUES (?, ?, ?)", id,
             static_cast<std::int64_t>(begin / piece_bytes), Blob{rest.substr(begin, piece_bytes)})
        .exec();
  }
  drop_beyond_limits();
  return true;
}

// --- what is kept

void SqliteStore::tidy() {
  constexpr std::int64_t between_readings = 600'000;
  write_what_frees([&] {
    drop_beyond_limits();
    const KeptClock clock = clock_.reading();
    prepared(writer_, "UPDATE state SET retention = ?, wall = ? WHERE abs(wall - ?) > ?", clock.retention,
             clock.wall, clock.wall, between_readings)
        .exec();
    return true;
  });
  shrink();
}

/// Within a step, which should stay short: what is left over goes with the next one.
void SqliteStore::drop_beyond_limits() {
  constexpr int most_at_once = 100;
  const bool by_age = !clock_.holds();
  for (int i = 0; i < most_at_once; ++i) {
    writer_.exec("SAVEPOINT dropping");
    try {
      const bool dropped = drop_oldest_beyond_limits(by_age);
      writer_.exec("RELEASE dropping");
      if (!dropped) return;
    } catch (const SQLite::Exception& error) {
      // What cannot be dropped must not hinder what is to be kept.
      if (!is_damage(error)) throw;
      note_trouble(error);
      writer_.exec("ROLLBACK TO dropping; RELEASE dropping");
      return;
    }
  }
}

/// False if nothing is beyond the limits.
bool SqliteStore::drop_oldest_beyond_limits(bool by_age) {
  const std::int64_t oldest =
      clock_.now() - std::chrono::duration_cast<std::chrono::milliseconds>(limits_.keep).count();
  auto row = prepared(writer_, "SELECT id, ended, bytes, " + is_intact +
                                   ", (SELECT ended_bytes FROM state) FROM jobs WHERE ended IS NOT NULL "
                                   "ORDER BY ended, id LIMIT 2");
  if (!row.executeStep()) return false;
  const std::string id = row.getColumn(0).getString();
  const bool expired = by_age && row.getColumn(1).getInt64() < oldest;
  const std::int64_t bytes = row.getColumn(2).getInt64();
  const bool intact = row.getColumn(3).getInt() != 0;
  const std::int64_t kept_bytes = row.getColumn(4).getInt64();
  const bool last = !row.executeStep();
  if (!expired && (last || kept_bytes <= static_cast<std::int64_t>(limits_.keep_bytes))) return false;
  row.reset();
  if (!intact) {
    fail_as_damaged(writer_, id, "entry in the list of solves", clock_.now());
    return true;
  }
  prepared(writer_, "DELETE FROM jobs WHERE id = ?", id).exec();
  prepared(writer_, "UPDATE state SET ended_bytes = ended_bytes - ?", bytes).exec();
  const LogField job("job", id);
  spdlog::info("dropped bytes={} kept_bytes={} ({})", bytes, kept_bytes - bytes,
               expired ? "--keep-seconds" : "--keep-bytes");
  return true;
}

/// Gives some of the pages that nothing uses back to the disk, if there are many, or if the disk is full.
void SqliteStore::shrink() {
  constexpr int many = 256, at_once = 4096;
  try {
    commits_.run_alone([this] {
      const int unused = writer_.execAndGet("PRAGMA freelist_count").getInt();
      const bool full = !has_room();
      if (unused <= (full ? 0 : many)) return;
      // The log first, so that there is room for that of what is moved.
      if (full) writer_.exec("PRAGMA wal_checkpoint(TRUNCATE)");
      writer_.exec("PRAGMA incremental_vacuum(" + std::to_string(at_once) + ")");
      writer_.exec(full ? "PRAGMA wal_checkpoint(TRUNCATE)" : "PRAGMA wal_checkpoint(PASSIVE)");
      if (full) has_room();
    });
  } catch (const SQLite::Exception& error) {
    note_trouble(error);
  }
}

/// The process that left these jobs as running is dead: nobody else has the directory.
void SqliteStore::recover() {
  write_what_frees([&] {
    clock_ = RetentionClock(kept_clock(writer_));
    const KeptClock clock = clock_.reading();
    prepared(writer_,
             "REPLACE INTO state SELECT 1, ifnull(sum(bytes), 0), ?, ? FROM jobs WHERE ended IS NOT NULL",
             clock.retention, clock.wall)
        .exec();
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
      end(id, JobStatus::running, std::nullopt, ending, {});
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
  return read([&] {
    std::optional<std::string> read_to = oldest_read(reader_, query);
    auto row = selection(reader_, job_columns, query, read_to.value_or(before_every_id),
                         static_cast<std::int64_t>(query.limit) + 1);
    std::vector<Job> jobs;
    while (row.executeStep()) jobs.push_back(job_of(row));
    return page_of(std::move(jobs), query.limit, std::move(read_to));
  });
}

std::vector<std::string> SqliteStore::ids(const ListQuery& query) const {
  constexpr std::int64_t all = -1;
  return read([&] {
    std::vector<std::string> ids;
    auto row = selection(reader_, "id", query, before_every_id, all);
    while (row.executeStep()) ids.push_back(row.getColumn(0).getString());
    return ids;
  });
}

JobCounts SqliteStore::count() const {
  return read([&] {
    auto row = prepared(reader_, "SELECT status, count(*) FROM jobs GROUP BY status");
    return counts_in(row);
  });
}

std::optional<Batch> SqliteStore::find_batch(const std::string& id) const {
  return read([&]() -> std::optional<Batch> {
    auto row = prepared(reader_, "SELECT " + batch_columns + " FROM batches WHERE id = ?", id);
    if (!row.executeStep()) return std::nullopt;
    return batch_of(row);
  });
}

JobCounts SqliteStore::count_of_batch(const std::string& id) const {
  return read([&] {
    auto row = prepared(
        reader_, "SELECT status, count(*) FROM jobs WHERE batch <> '' AND batch = ? GROUP BY status", id);
    return counts_in(row);
  });
}

BatchEnds SqliteStore::ends_of_batch(const std::string& id, std::int64_t since) const {
  const std::string of_batch = " FROM jobs WHERE batch <> '' AND batch = ? AND ended ";
  return read([&] {
    BatchEnds ends;
    ends.latest = since;
    // Asked first: what ends in between is then among those that follow.
    ends.all = !prepared(reader_, "SELECT 1" + of_batch + "IS NULL LIMIT 1", id).executeStep();
    auto row = prepared(reader_, "SELECT id, ended" + of_batch + ">= ? ORDER BY ended", id, since);
    while (row.executeStep()) {
      ends.jobs.push_back(row.getColumn(0).getString());
      ends.latest = row.getColumn(1).getInt64();
    }
    return ends;
  });
}

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

// --- what stands in the way

/// Why there is no room for more than what frees some; with the mutex.
std::optional<std::string> SqliteStore::hindrance() {
  if (auto limit = limit_of_growth(directory_.database(), DiskReserve::bytes)) return limit;
  return reserve_.room() ? std::nullopt : std::optional<std::string>(disk_is_full);
}

/// On the disk, for more than what frees some.
bool SqliteStore::has_room() {
  const std::lock_guard lock(trouble_mutex_);
  return !hindrance();
}

/// Throws StoreUnavailable if nothing more is to be put on the disk.
void SqliteStore::require_room() {
  const std::lock_guard lock(trouble_mutex_);
  const std::optional<std::string> reason = hindrance();
  if (!reason) return;
  if (!trouble_) spdlog::error("{}", *reason);
  trouble_ = reason;
  throw StoreUnavailable(*reason);
}

std::optional<std::string> SqliteStore::trouble() {
  {
    const std::lock_guard lock(trouble_mutex_);
    if (damage_) return damage_;
    if (auto reason = hindrance()) return reason;
    if (!trouble_) return std::nullopt;
  }
  try {
    write([&] {
      // Writes the first page, as it is.
      writer_.exec("PRAGMA user_version = " + std::to_string(schema_version()));
      return true;
    });
  } catch (const StoreUnavailable& unavailable) {
    return unavailable.what();
  }
  const std::lock_guard lock(trouble_mutex_);
  if (trouble_) spdlog::info("the data directory can be written again");
  trouble_.reset();
  return std::nullopt;
}

}  // namespace signorini::server
