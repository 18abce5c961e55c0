#include "server/jobs/sqlite/repair.hpp"

#include <algorithm>
#include <functional>

#include <unistd.h>

#include <sqlite3.h>

#include "server/jobs/retention_clock.hpp"
#include "server/jobs/sqlite/job_rows.hpp"
#include "server/jobs/sqlite/result_bytes.hpp"
#include "server/jobs/sqlite/salvage.hpp"
#include "server/jobs/sqlite/schema.hpp"
#include "server/jobs/sqlite/write_ahead_log.hpp"
#include "server/jobs/store.hpp"
#include "server/jobs/stored_form.hpp"

namespace signorini::server {
namespace {

using std::filesystem::path;

CannotOpenStore cannot_open(const path& file, const std::string& why) {
  return CannotOpenStore("cannot open the jobs in " + file.string() + ": " + why + " (--data-dir)");
}

std::vector<std::string> texts(const SQLite::Database& database, const std::string& sql) {
  std::vector<std::string> list;
  SQLite::Statement row(database, sql);
  while (row.executeStep()) list.push_back(row.getColumn(0).getString());
  return list;
}

// --- the file

std::string schema_of(const SQLite::Database& database) {
  std::string schema;
  for (const std::string& part : texts(database,
                                       "SELECT type || name || tbl_name || sql FROM sqlite_master "
                                       "WHERE sql IS NOT NULL ORDER BY name"))
    schema += part + '\n';
  return schema;
}

/// Whether the tables are those of their version, to the letter. A newer one is not known here.
bool has_its_schema(SQLite::Database& database) {
  const int version = database.execAndGet("PRAGMA user_version").getInt();
  SQLite::Database fresh(":memory:", SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  migrate(fresh, std::min(version, schema_version()));
  return (schema_of(database) == schema_of(fresh)) == (version <= schema_version());
}

/// An error that says that the file is damaged, and not that it cannot be reached.
bool is_of_file(const SQLite::Exception& error, const path& file) {
  // A flipped bit can say that only newer programs may write it.
  const bool may_write = ::access(file.c_str(), W_OK) == 0;
  return !passing_reason(error) || (error.getErrorCode() == SQLITE_READONLY && may_write);
}

/// What is wrong with how the file hangs together; nothing if nothing is.
std::optional<std::string> fault_of_file(const path& file, const std::string& vfs) {
  try {
    Database database = connect(file, vfs);
    SQLite::Statement check(database, "PRAGMA integrity_check(1)");
    check.executeStep();
    const std::string verdict = check.getColumn(0).getString();
    if (verdict != "ok") return verdict;
    return has_its_schema(database) ? std::nullopt
                                    : std::optional<std::string>("its tables are not those of its version");
  } catch (const SQLite::Exception& error) {
    if (is_of_file(error, file)) return error.getErrorStr();
    throw cannot_open(file, error.getErrorStr());
  }
}

void remove_with_log(const path& file) {
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + suffix);
}

/// Puts a file in the place of another, which is kept beside it.
void exchange_files(const path& fresh, const path& file) {
  const path aside = file.string() + ".damaged";
  remove_with_log(aside);
  for (const char* suffix : {"-wal", ""}) {
    const path from = file.string() + suffix;
    if (std::filesystem::exists(from)) std::filesystem::rename(from, aside.string() + suffix);
  }
  remove_with_log(file);
  std::filesystem::rename(fresh, file);
}

/// Returns how many jobs the new file has; if none, the old one stays.
std::size_t write_anew(const path& file, const std::string& fault, const std::string& vfs) {
  const path fresh = file.string() + ".new";
  remove_with_log(fresh);
  std::size_t found = 0;
  try {
    Database whole = connect(fresh, vfs);
    migrate(whole);
    found = salvage(file, whole);
  } catch (const SQLite::Exception& error) {
    throw cannot_open(file, fault + "; and it could not be repaired: " + error.getErrorStr());
  }
  if (found > 0)
    exchange_files(fresh, file);
  else
    remove_with_log(fresh);
  return found;
}

std::string brought_over(const path& file, const std::string& fault, std::size_t found) {
  return "the file did not hang together (" + fault + "); " + std::to_string(found) +
         " solves were brought into a new one, and the old one is kept as " + file.string() + ".damaged";
}

// --- the rows

/// Looks at each row beside the others, and repairs it.
class Rows {
 public:
  explicit Rows(Database& database) : database_(database) {}

  std::vector<std::string> repair(Depth depth) {
    find_strays();
    for (const std::string& id : texts(database_, "SELECT id FROM jobs WHERE NOT (" + is_intact + ")"))
      fail(id, "entry in the list of solves");
    for (const std::string& id : without_problem("AND NOT damaged")) fail(id, "problem");
    // It had ended once.
    for (const std::string& id : texts(database_,
                                       "SELECT id FROM jobs WHERE status IN ('queued', 'running') "
                                       "AND EXISTS (SELECT 1 FROM results WHERE job = id)"))
      fail(id, "entry in the list of solves");
    if (depth == Depth::all) look_into_all();
    for (const char* table : {"results", "idempotency_keys"})
      database_.exec(std::string("DELETE FROM ") + table + " WHERE job NOT IN (SELECT id FROM jobs)");
    renew_tags();
    remove_lost_batches();
    return damage_;
  }

 private:
  /// Problems without a job: either it has lost its row, or one of the two ids is not what was written.
  void find_strays() {
    for (const std::string& id :
         texts(database_, "SELECT job FROM problems WHERE job NOT IN (SELECT id FROM jobs)")) {
      if (!without_problem("AND (" + is_intact + ") AND NOT damaged").empty()) {
        prepared(database_, "DELETE FROM problems WHERE job = ?", id).exec();
        continue;
      }
      const std::vector<std::string> wrong = without_problem("AND NOT (" + is_intact + ")");
      if (!wrong.empty()) prepared(database_, "DELETE FROM jobs WHERE id = ?", wrong.front()).exec();
      prepared(database_,
               "INSERT INTO jobs (id, status, title, created, bytes, owner) VALUES (?1, 'failed', '', ?2, 0, "
               "ifnull((SELECT owner FROM idempotency_keys WHERE job = ?1), ''))",
               id, retention_)
          .exec();
      fail(id, "entry in the list of solves");
    }
  }

  /// Of which there is no job, or not what was written. The jobs are what they were.
  void remove_lost_batches() {
    database_.exec("DELETE FROM batches WHERE id NOT IN (SELECT batch FROM jobs)");
    std::vector<std::string> damaged;
    {
      auto row = prepared(database_, "SELECT " + batch_columns + " FROM batches");
      while (row.executeStep())
        if (!batch_of(row)) damaged.push_back(row.getColumn(0).getString());
    }
    for (const std::string& id : damaged) {
      prepared(database_, "DELETE FROM batches WHERE id = ?", id).exec();
      damage_.push_back("batch " + id + " is not what was written; its solves are there one by one");
    }
  }

  /// What follows from the tags of the jobs.
  void renew_tags() {
    const std::string of_jobs =
        "SELECT CAST(value AS BLOB), jobs.owner, jobs.id FROM jobs, "
        "json_each(CASE WHEN json_valid(jobs.tags) THEN jobs.tags ELSE '[]' END) WHERE jobs.tags <> ''";
    database_.exec("DELETE FROM job_tags WHERE (tag, owner, job) NOT IN (" + of_jobs + ")");
    database_.exec("INSERT OR IGNORE INTO job_tags " + of_jobs);
  }

  std::vector<std::string> without_problem(const std::string& condition) const {
    return texts(database_, "SELECT id FROM jobs WHERE id NOT IN (SELECT job FROM problems) " + condition);
  }

  void look_into_all() {
    for (const std::string& id : texts(database_, "SELECT id FROM jobs WHERE NOT damaged")) {
      if (!problem_of(database_, id)) {
        fail(id, "problem");
      } else if (!has_its_result(id)) {
        fail(id, "result");
      }
    }
  }

  bool has_its_result(const std::string& id) const {
    Verdict verdict;
    {
      auto row = prepared(database_, "SELECT " + job_columns + " FROM jobs WHERE id = ?", id);
      row.executeStep();
      verdict = job_of(row).verdict;
    }
    ResultBytes bytes(database_, id);
    if (bytes.size() == 0) return !verdict.summary && !verdict.last_iteration;
    try {
      JobResult result;
      unpack_findings(std::bind_front(&ResultBytes::read, &bytes), result);
      return true;
    } catch (const std::runtime_error&) {
      return false;
    }
  }

  void fail(const std::string& id, const std::string& what) {
    fail_as_damaged(database_, id, what, retention_);
    damage_.push_back("the " + what + " of solve " + id + " is not what was written; it is failed now");
  }

  Database& database_;
  const std::int64_t retention_ = RetentionClock().now();
  std::vector<std::string> damage_;
};

std::vector<std::string> repair_rows(const path& file, Depth depth, const std::string& vfs) {
  Database database = connect(file, vfs);
  migrate(database);
  seal_changes(database);
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  std::vector<std::string> damage = Rows(database).repair(depth);
  transaction.commit();
  return damage;
}

}  // namespace

Findings repair(const DataDir& directory, Depth depth, const std::string& vfs) {
  const path file = directory.database();
  Findings findings;
  // Before SQLite, which cuts the log off where it is damaged.
  if (const std::optional<std::string> fault = WriteAheadLog(file).fault()) {
    const std::size_t found = write_anew(file, *fault, vfs);
    findings.damage.push_back(found > 0 ? brought_over(file, *fault, found)
                                        : *fault + ", and no solve can be read from it");
  }
  const auto repair_them = [&] {
    for (std::string& damage : repair_rows(file, depth, vfs)) findings.damage.push_back(std::move(damage));
  };
  std::optional<std::string> fault = fault_of_file(file, vfs);
  if (!fault) {
    try {
      repair_them();
      return findings;
    } catch (const SQLite::Exception& error) {
      if (!is_of_file(error, file)) throw cannot_open(file, error.getErrorStr());
      fault = error.getErrorStr();
    }
  }
  const std::size_t found = write_anew(file, *fault, vfs);
  if (found == 0)
    throw cannot_open(file,
                      *fault + ", and no solve can be read from it: take a backup, or another directory");
  findings.damage.push_back(brought_over(file, *fault, found));
  try {
    repair_them();
  } catch (const SQLite::Exception& error) {
    throw cannot_open(file, error.getErrorStr());
  }
  return findings;
}

}  // namespace signorini::server
