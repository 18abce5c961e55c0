#include "server/jobs/postgres/store.hpp"

#include <algorithm>
#include <functional>

#include <spdlog/spdlog.h>

#include "server/jobs/postgres/rows.hpp"
#include "server/jobs/postgres/selection.hpp"
#include "server/jobs/postgres/stored_result.hpp"
#include "server/jobs/postgres/turns.hpp"
#include "server/jobs/stored_form.hpp"
#include "server/log.hpp"

namespace signorini::server::postgres {
namespace {

constexpr std::size_t piece_bytes = std::size_t{1} << 20;
constexpr const char* unique_violation = "23505";

ListQuery with_title_in_lower_case(ListQuery query) {
  if (query.title) query.title = lower_case(*std::move(query.title));
  return query;
}

JobCounts counts_in(const Rows& rows) {
  JobCounts counts;
  for (int row = 0; row < rows.size(); ++row)
    counts[job_status(rows.view(row, 0)).value_or(JobStatus::failed)] +=
        static_cast<std::size_t>(rows.integer(row, 1));
  return counts;
}

/// A title; texts of the database hold no zero byte.
std::string without_zeros(std::string title) {
  for (std::size_t zero = title.find('\0'); zero != std::string::npos; zero = title.find('\0', zero))
    title.replace(zero, 1, "\uFFFD");
  return title;
}

/// Puts a job into the queue behind the others of its owner: in turns with other owners, whatever they have
/// queued before.
void insert(Connection& connection, const NewJob& job, const std::string& packed) {
  static const std::string sql =
      "WITH new AS (INSERT INTO jobs (id, status, title, tags, owner, batch, trace, created, memory, share, "
      "bytes, mark, step, turn) VALUES ($1, 'queued', $2, $3, $4, $5, $6, $7, $8, $9, $10, $11, $12::float8, "
      "$12::float8 + "
      "greatest(" +
      turn_now +
      ", (SELECT max(turn) FROM queue WHERE owner = $4))) "
      "RETURNING id, turn, owner, batch, memory, share, mark), "
      "waiting AS (INSERT INTO queue (job, turn, owner, batch, memory, share, mark) SELECT * FROM new) "
      "INSERT INTO problems SELECT id, $13::bytea FROM new";
  connection.run(sql, Values(job.id, without_zeros(job.title), pack_list(job.tags), job.owner, job.batch,
                             job.trace, to_milliseconds(job.created), job.predicted_memory, job.share.memory,
                             packed.size(), job.operator_mark, 1 / job.share.weight, Bytes{packed}));
  if (job.key)
    connection.run("INSERT INTO idempotency_keys (owner, key, job) VALUES ($1, $2, $3)",
                   Values(job.owner, *job.key, job.id));
  if (!job.tags.empty())
    connection.run(
        "INSERT INTO job_tags SELECT DISTINCT convert_to(tag, 'UTF8'), $2, $3 FROM unnest($1::text[]) AS tag",
        Values(job.tags, job.owner, job.id));
}

}  // namespace

// --- the life of a job

Store::Store(const std::string& url, const StoreLimits& limits, std::chrono::milliseconds lease)
    : limits_(limits), database_(url), leases_(database_, lease), sweeper_(database_, limits) {}

/// Adds something as a whole. Nothing, or what somebody else has added meanwhile who came with the same key.
template <class Known, class Add>
auto Store::add_unless(const Known& known, const Add& add) -> decltype(known()) {
  try {
    database_.with([&](Connection& connection) {
      Transaction transaction(connection);
      add(connection);
      transaction.commit();
      return true;
    });
    return std::nullopt;
  } catch (const Error& error) {
    if (error.state != unique_violation) throw;
    if (auto same = known()) return same;
    throw;
  } catch (const QueueFull&) {
    if (auto same = known()) return same;
    throw;
  }
}

std::string Store::add(NewJob job) {
  const auto known = [&] { return job.key ? earlier(job.owner, *job.key, *job.problem) : std::nullopt; };
  if (const auto id = known()) return *id;
  const std::string packed = pack_text(*job.problem);
  const auto same = add_unless(known, [&](Connection& connection) {
    require_places(connection, 1, job.owner, job.share);
    insert(connection, job, packed);
  });
  return same.value_or(job.id);
}

Batch Store::add(NewBatch batch) {
  const Batch& made = batch.batch;
  const auto known = [&] {
    return batch.key ? earlier_batch(made.owner, *batch.key, batch.digest) : std::nullopt;
  };
  if (auto earlier = known()) return *std::move(earlier);
  std::vector<std::string> packed;
  for (const NewJob& job : batch.jobs) packed.push_back(pack_text(*job.problem));
  const std::string content = pack_content(made);
  auto same = add_unless(known, [&](Connection& connection) {
    require_places(connection, batch.jobs.size(), made.owner, batch.jobs.front().share);
    connection.run("INSERT INTO batches VALUES ($1, $2, $3, $4, $5)",
                   Values(made.id, made.owner, to_milliseconds(made.created), batch.digest, Bytes{content}));
    if (batch.key)
      connection.run("INSERT INTO idempotency_keys (owner, key, batch) VALUES ($1, $2, $3)",
                     Values(made.owner, *batch.key, made.id));
    for (std::size_t i = 0; i < packed.size(); ++i) insert(connection, batch.jobs[i], packed[i]);
  });
  return same ? *std::move(same) : made;
}

/// Throws QueueFull if no request more may wait, or not so many jobs of the owner. Those of others who come
/// at the same time are not seen; those of an owner with a share come one after the other.
void Store::require_places(Connection& connection, std::size_t jobs, const std::string& owner,
                           const Share& share) const {
  // There are no more requests than jobs, which are counted already. Those that are alone, and each batch
  // once.
  const Rows full = connection.run(
      "SELECT 1 WHERE (SELECT sum(queued) FROM tallies) >= $1::bigint AND (SELECT count(*) FROM "
      "(SELECT DISTINCT CASE batch WHEN '' THEN job ELSE batch END FROM queue WHERE priority < $2::integer) "
      "AS requests) >= $1::bigint",
      Values(limits_.queue, priority_of_chunks));
  if (!full.empty()) throw QueueFull(limits_.queue);
  if (!share.queue) return;
  connection.lock("queue of " + owner);
  const Rows beyond = connection.run(
      "SELECT count(*) + $2::bigint > $3::bigint FROM queue WHERE owner = $1 "
      "AND priority < $4::integer",
      Values(owner, jobs, *share.queue, priority_of_chunks));
  if (beyond.boolean(0, 0)) throw QueueFull(*share.queue, true);
}

std::optional<std::string> Store::earlier(const std::string& owner, const std::string& key,
                                          const std::string& problem) {
  const Rows rows = database_.run(
      "SELECT keys.job, keys.batch, text FROM idempotency_keys AS keys LEFT JOIN problems ON problems.job = "
      "keys.job "
      "WHERE owner = $1 AND key = $2",
      Values(owner, key));
  if (rows.empty()) return std::nullopt;
  if (rows.is_null(0, 0)) throw KeyReused(rows.text(0, 1), true);
  const auto known = problem_of(rows.text(0, 2));
  if (known && *known != problem) throw KeyReused(rows.text(0, 0));
  return rows.text(0, 0);
}

std::optional<Batch> Store::earlier_batch(const std::string& owner, const std::string& key,
                                          const std::string& digest) {
  const Rows rows = database_.run(
      "SELECT id, batches.owner, created, content, digest, keys.job FROM idempotency_keys AS keys "
      "LEFT JOIN batches ON id = batch WHERE keys.owner = $1 AND key = $2",
      Values(owner, key));
  if (rows.empty()) return std::nullopt;
  if (!rows.is_null(0, 5)) throw KeyReused(rows.text(0, 5));
  if (rows.view(0, 4) != digest) throw KeyReused(rows.text(0, 0), true);
  return batch_of(rows, 0);
}

/// Large results are stored before their job ends, piece by piece, so that nothing waits for them. Each
/// piece, and the end, must find the claim.
bool Store::finish(const Claim& claim, const Ending& ending) {
  const std::string findings = pack_findings(ending);
  const std::string verdict = pack_verdict(verdict_of(ending));
  const std::string_view rest = findings;
  const std::size_t before_last = findings.empty() ? 0 : (findings.size() - 1) / piece_bytes;
  for (std::size_t piece = 0; piece < before_last; ++piece) {
    const Rows stored = database_.run(
        "INSERT INTO results SELECT job, attempt, $3::integer, $4::bytea FROM leases WHERE job = $1 AND "
        "attempt = $2 "
        "FOR KEY SHARE ON CONFLICT (job, attempt, piece) DO UPDATE SET bytes = excluded.bytes RETURNING 1",
        Values(claim.job.id, claim.attempt, piece, Bytes{rest.substr(piece * piece_bytes, piece_bytes)}));
    if (stored.empty()) return refuse(claim, verdict);
  }
  static const std::string sql =
      "WITH held AS (DELETE FROM leases WHERE job = $1 AND attempt = $2 RETURNING job), "
      "ended AS (UPDATE jobs SET status = $3, finished = clock_ms(), verdict = $4, bytes = bytes + $5, "
      "damaged = $6 FROM held WHERE id = held.job RETURNING id, bytes), "
      "piece AS (INSERT INTO results SELECT id, $2, $7::integer, $8::bytea FROM ended), "
      "told AS (INSERT INTO progress SELECT id, $2, 0, $9::integer, $10::bytea FROM ended "
      "WHERE $9::integer > 0 "
      "ON CONFLICT (job, attempt, first) DO UPDATE SET count = excluded.count, iterations = "
      "excluded.iterations), "
      "told_before AS (DELETE FROM progress USING ended WHERE job = id AND (attempt < $2 OR first > 0)), "
      "stale AS (DELETE FROM results USING ended WHERE job = id AND attempt < $2) "
      "SELECT bytes FROM ended";
  const std::vector<Iteration> none;
  const std::vector<Iteration>& history = ending.history ? *ending.history : none;
  const std::string iterations = pack_iterations(history);
  const Rows rows = database_.run(
      sql, Values(claim.job.id, claim.attempt, name(ending.status), Bytes{verdict}, findings.size(),
                  is_damaged(ending), before_last, Bytes{rest.substr(before_last * piece_bytes)},
                  history.size(), Bytes{iterations}));
  if (rows.empty()) return refuse(claim, verdict);
  sweeper_.ended(static_cast<std::size_t>(rows.integer(0, 0)));
  return true;
}

/// False. It counts, unless it is the end that the job has: then the answer to an earlier try was lost.
bool Store::refuse(const Claim& claim, const std::string& verdict) {
  const Rows same = database_.run("SELECT FROM jobs WHERE id = $1 AND attempt = $2 AND verdict = $3",
                                  Values(claim.job.id, claim.attempt, Bytes{verdict}));
  if (same.empty()) leases_.refuse();
  return false;
}

Cancellation Store::cancel(const std::string& id) {
  const std::string verdict =
      pack_verdict(verdict_of(cancelled_ending("The solve was cancelled before it began.")));
  const Rows waiting = database_.run(
      "WITH taken AS (DELETE FROM queue WHERE job = $1 RETURNING job) "
      "UPDATE jobs SET status = 'cancelled', finished = clock_ms(), verdict = $2 FROM taken WHERE id = job "
      "RETURNING bytes",
      Values(id, Bytes{verdict}));
  if (!waiting.empty()) {
    sweeper_.ended(static_cast<std::size_t>(waiting.integer(0, 0)));
    return Cancellation::ended;
  }
  const Rows running = database_.run(
      "UPDATE leases SET cancel_asked = true WHERE job = ANY(ARRAY(SELECT $1 UNION ALL SELECT id FROM jobs "
      "WHERE whole = $1)) RETURNING job",
      Values(id));
  return running.empty() ? Cancellation::none : Cancellation::asked;
}

bool Store::remove_ended(const std::string& id) {
  return remove_ended(std::span(&id, 1)) == 1;
}

std::size_t Store::remove_ended(std::span<const std::string> ids) {
  const Rows rows =
      database_.run("DELETE FROM jobs WHERE id = ANY($1::text[]) AND finished IS NOT NULL RETURNING 1",
                    Values(std::vector<std::string>(ids.begin(), ids.end())));
  return static_cast<std::size_t>(rows.size());
}

void Store::tidy() {
  sweeper_.ended(0);
}

// --- readers

std::optional<Job> Store::find(const std::string& id) const {
  if (!may_be_an_id(id)) return std::nullopt;
  const Rows rows =
      database_.run("SELECT " + job_columns + " FROM jobs WHERE id = $1 AND whole IS NULL", Values(id));
  if (rows.empty()) return std::nullopt;
  return job_of(rows, 0);
}

JobPage Store::list(const ListQuery& asked) const {
  const ListQuery query = with_title_in_lower_case(asked);
  std::optional<std::string> read_to;
  if (query.title) {
    const Selection last = oldest_read(query);
    const Rows rows = database_.run(last.sql, last.values);
    if (!rows.empty()) read_to = rows.text(0, 0);
  }
  const Selection selected = selection(job_columns, query, read_to.value_or(""), query.limit + 1);
  const Rows rows = database_.run(selected.sql, selected.values);
  std::vector<Job> jobs;
  for (int row = 0; row < rows.size(); ++row) jobs.push_back(job_of(rows, row));
  return page_of(std::move(jobs), query.limit, read_to);
}

std::vector<std::string> Store::ids(const ListQuery& asked) const {
  const ListQuery query = with_title_in_lower_case(asked);
  const Selection selected = selection("id", query, "", std::nullopt);
  const Rows rows = database_.run(selected.sql, selected.values);
  std::vector<std::string> ids;
  for (int row = 0; row < rows.size(); ++row) ids.push_back(rows.text(row, 0));
  return ids;
}

JobCounts Store::count() const {
  JobCounts counts = counts_in(database_.run(
      "SELECT status, sum(number)::bigint FROM tallies, LATERAL (VALUES ('queued', queued), "
      "('running', running), ('succeeded', succeeded), ('failed', failed), ('cancelled', cancelled)) "
      "AS each (status, number) GROUP BY status"));
  std::erase_if(counts, [](const auto& each) { return each.second == 0; });
  return counts;
}

std::optional<Batch> Store::find_batch(const std::string& id) const {
  if (!may_be_an_id(id)) return std::nullopt;
  const Rows rows =
      database_.run("SELECT " + batch_columns +
                        " FROM batches WHERE id = $1 AND EXISTS (SELECT FROM jobs WHERE batch = $1)",
                    Values(id));
  if (rows.empty()) return std::nullopt;
  return batch_of(rows, 0);
}

JobCounts Store::count_of_batch(const std::string& id) const {
  return counts_in(database_.run(
      "SELECT status, count(*) FROM jobs WHERE batch <> '' AND batch = $1 GROUP BY status", Values(id)));
}

BatchEnds Store::ends_of_batch(const std::string& id, std::int64_t since) const {
  // One that ended earlier than another may be seen later: as late as a statement may take.
  constexpr std::int64_t longest = std::chrono::milliseconds(longest_statement).count();
  const Rows rows = database_.run(
      "SELECT id, finished FROM jobs WHERE batch <> '' AND batch = $1 AND (finished IS NULL OR finished >= "
      "$2) "
      "ORDER BY finished NULLS LAST, id",
      Values(id, since));
  BatchEnds ends;
  ends.latest = since;
  for (int row = 0; row < rows.size(); ++row) {
    if (rows.is_null(row, 1)) {
      ends.all = false;
      break;
    }
    ends.jobs.push_back(rows.text(row, 0));
    ends.latest = std::max(since, rows.integer(row, 1) - longest);
  }
  // The clock may have been set back meanwhile.
  if (ends.all && since > 0) return ends_of_batch(id, 0);
  return ends;
}

std::optional<JobResult> Store::result(const std::string& id) {
  const std::optional<Job> job = find(id);
  if (!job) return std::nullopt;
  const bool has_result = job->verdict.summary || job->verdict.last_iteration;
  return database_.with([&](Connection& connection) -> std::optional<JobResult> {
    const char* damaged = nullptr;
    JobResult result;
    {
      // All from one state of the database.
      Transaction transaction(connection, "REPEATABLE READ READ ONLY");
      const Rows rows = connection.run("SELECT text FROM problems WHERE job = $1", Values(id));
      if (!rows.empty()) result.problem = problem_of(rows.text(0, 0));
      StoredResult bytes(connection, id);
      try {
        if (!result.problem) {
          damaged = "problem";
        } else if (has_result && bytes.size() > 0) {
          unpack_findings(std::bind_front(&StoredResult::read, &bytes), result);
        } else if (has_result) {
          damaged = "result";
        }
      } catch (const Error&) {
        throw;
      } catch (const std::runtime_error&) {
        damaged = "result";
      }
      transaction.commit();
    }
    if (damaged == nullptr) return result;
    return damaged_result(connection, id, damaged);
  });
}

std::size_t Store::result_memory(const std::string& id) const {
  return database_.with([&](Connection& connection) -> std::size_t {
    StoredResult bytes(connection, id);
    if (bytes.size() == 0) return 0;
    try {
      return unpacked_size(std::bind_front(&StoredResult::read, &bytes));
    } catch (const Error&) {
      throw;
    } catch (const std::runtime_error&) {
      return 0;  // the result will turn out to be damaged
    }
  });
}

/// Nothing if the job was removed meanwhile.
std::optional<JobResult> Store::damaged_result(Connection& connection, const std::string& id,
                                               const std::string& what) {
  const std::string verdict = pack_verdict(verdict_of(damaged_ending(what)));
  // A worker that has it finds out by itself.
  const Rows failed = connection.run(
      "UPDATE jobs SET status = 'failed', verdict = $2, damaged = true WHERE id = $1 AND finished IS NOT "
      "NULL "
      "AND NOT damaged RETURNING id",
      Values(id, Bytes{verdict}));
  if (!failed.empty()) {
    const LogField job("job", id);
    spdlog::error("failed kind=damaged: its {} is not what was written", what);
  }
  if (connection.run("SELECT 1 FROM jobs WHERE id = $1", Values(id)).empty()) return std::nullopt;
  return JobResult{std::make_shared<const std::string>("null"), nullptr, nullptr};
}

std::size_t Store::damaged() const {
  if (const auto rows = database_.glance("SELECT sum(damaged)::bigint FROM tallies"))
    damaged_ = static_cast<std::size_t>(rows->integer(0, 0));
  return damaged_;
}

}  // namespace signorini::server::postgres
