// Entries of a sweep that are jobs of their own.

#include "server/jobs/postgres/leases.hpp"

#include <functional>

#include "server/jobs/postgres/rows.hpp"
#include "server/jobs/postgres/stored_result.hpp"
#include "server/jobs/postgres/turns.hpp"
#include "server/jobs/stored_form.hpp"

namespace signorini::server::postgres {
namespace {

/// Sorts behind the whole, and before what came later.
std::string id_of_chunk(const std::string& whole, std::size_t number) {
  const std::string digits = std::to_string(number);
  return whole + "C" + std::string(4 - std::min<std::size_t>(4, digits.size()), '0') + digits;
}

}  // namespace

bool Leases::split(const Claim& whole, std::span<const NewChunk> chunks) {
  static const std::string sql =
      "WITH new AS (INSERT INTO jobs (id, status, title, tags, owner, batch, trace, created, memory, share, "
      "bytes, mark, step, priority, whole, first_entry, entries, turn) SELECT $2, 'queued', '', '', owner, "
      "'', trace, started, $3::float8, share, $4::bigint, mark, step, $5::smallint, id, $6::integer, "
      "$7::integer, "
      "step + greatest(" +
      turn_now +
      ", (SELECT max(turn) FROM queue WHERE owner = whole.owner)) FROM jobs AS whole WHERE id = $1 "
      "RETURNING id, turn, owner, batch, memory, share, mark, priority), "
      "waiting AS (INSERT INTO queue (job, turn, owner, batch, memory, share, mark, priority) "
      "SELECT * FROM new) "
      "INSERT INTO problems SELECT id, $8::bytea FROM new";
  const bool is_held = database_.with([&](Connection& connection) {
    Transaction transaction(connection);
    const Rows held = connection.run(
        "SELECT FROM leases WHERE job = $1 AND attempt = $2 AND NOT cancel_asked "
        "FOR KEY SHARE",
        Values(whole.job.id, whole.attempt));
    if (held.empty()) return false;
    connection.run("UPDATE jobs SET chunks = $2::integer WHERE id = $1", Values(whole.job.id, chunks.size()));
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      const NewChunk& chunk = chunks[i];
      const std::string packed = pack_text(chunk.problem);
      connection.run(sql, Values(whole.job.id, id_of_chunk(whole.job.id, i), chunk.predicted_memory,
                                 packed.size(), priority_of_chunks, chunk.first, chunk.count, Bytes{packed}));
    }
    transaction.commit();
    return true;
  });
  return is_held;
}

std::vector<ChunkStanding> Leases::chunks(const std::string& whole) const {
  const Rows rows = database_.run(
      "SELECT id, first_entry, entries, status, verdict, state FROM jobs LEFT JOIN leases "
      "ON leases.job = id AND leases.attempt = jobs.attempt WHERE whole = $1 ORDER BY first_entry",
      Values(whole));
  std::vector<ChunkStanding> all;
  for (int row = 0; row < rows.size(); ++row) {
    ChunkStanding chunk;
    chunk.job = rows.text(row, 0);
    chunk.first = static_cast<std::size_t>(rows.integer(row, 1));
    chunk.count = static_cast<std::size_t>(rows.integer(row, 2));
    chunk.status = job_status(rows.view(row, 3)).value_or(JobStatus::failed);
    try {
      if (!rows.is_null(row, 4)) {
        const Verdict verdict = unpack_verdict(rows.text(row, 4));
        chunk.is_given_up = verdict.error && verdict.error->kind == attempts_used_up().error->kind;
      }
      if (!rows.is_null(row, 5)) chunk.swept = unpack_progress(rows.text(row, 5)).swept;
    } catch (const std::runtime_error&) {
      // Then nothing is known of it but that.
    }
    all.push_back(std::move(chunk));
  }
  return all;
}

std::optional<Claim> Leases::claim_chunk(const std::string& whole) {
  static const std::string sql =
      "WITH next AS (DELETE FROM queue WHERE job = (SELECT job FROM queue JOIN jobs ON id = job "
      "WHERE whole = $1 ORDER BY first_entry LIMIT 1 FOR UPDATE OF queue SKIP LOCKED) RETURNING job), "
      "claimed AS (UPDATE jobs SET status = 'running', started = clock_ms(), attempt = attempt + 1 "
      "FROM next WHERE id = next.job RETURNING " +
      job_columns +
      ", attempt), "
      "lease AS (INSERT INTO leases (job, attempt, until, owner, memory) "
      "SELECT id, attempt, started + $2::bigint, owner, 0 FROM claimed) "
      "SELECT " +
      job_columns + ", attempt FROM claimed";
  const Rows rows = database_.run(sql, Values(whole, lease_.count()));
  if (rows.empty()) return std::nullopt;
  return Claim{job_of(rows, 0), nullptr, static_cast<std::uint64_t>(rows.integer(0, job_column_count))};
}

std::vector<SweepEntry> Leases::entries(const std::string& chunk) const {
  return database_.with([&](Connection& connection) -> std::vector<SweepEntry> {
    StoredResult bytes(connection, chunk);
    if (bytes.size() == 0) return {};
    JobResult result;
    try {
      unpack_findings(std::bind_front(&StoredResult::read, &bytes), result);
    } catch (const Error&) {
      throw;
    } catch (const std::runtime_error&) {
      return {};
    }
    return result.solution ? result.solution->sweep : std::vector<SweepEntry>();
  });
}

}  // namespace signorini::server::postgres
