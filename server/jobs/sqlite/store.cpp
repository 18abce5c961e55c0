// The life of a job.

#include "server/jobs/sqlite/store.hpp"

#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/steps.hpp"
#include "server/jobs/stored_form.hpp"

namespace signorini::server {
namespace {

/// SQLite copies each as it writes it.
constexpr std::size_t piece_bytes = std::size_t{4} << 20;

}  // namespace

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

}  // namespace signorini::server
