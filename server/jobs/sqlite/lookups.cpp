// What is asked of the jobs of a store.

#include "server/jobs/sqlite/store.hpp"

#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/steps.hpp"

namespace signorini::server {
namespace {

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

}  // namespace

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

}  // namespace signorini::server
