#include "server/jobs/sqlite/schema.hpp"

#include <array>

#include "server/jobs/store.hpp"

namespace signorini::server {
namespace {

// A step that was ever released stays as it is; a change is a new step.
constexpr std::array steps{
    // Times are milliseconds since 1970. `jobs` is what lists and status calls read: no large values.
    R"sql(
CREATE TABLE jobs (
  id TEXT PRIMARY KEY,                      -- sorts by age
  status TEXT NOT NULL,
  title TEXT NOT NULL,
  created INTEGER NOT NULL,
  started INTEGER,
  finished INTEGER,
  attempt INTEGER NOT NULL DEFAULT 0,       -- of the last claim; who ends the job must know it
  given_back INTEGER NOT NULL DEFAULT 0,    -- attempts that no dying process cut short
  cancel_asked INTEGER NOT NULL DEFAULT 0,
  verdict BLOB,                             -- stored_form.hpp
  bytes INTEGER NOT NULL                    -- of the problem and the result as stored
) STRICT, WITHOUT ROWID;
CREATE INDEX jobs_by_status ON jobs (status, id);
CREATE INDEX jobs_by_end ON jobs (finished, id, bytes) WHERE finished IS NOT NULL;

CREATE TABLE problems (
  job TEXT PRIMARY KEY REFERENCES jobs ON DELETE CASCADE,
  text BLOB NOT NULL                        -- stored_form.hpp
) STRICT;

CREATE TABLE results (
  job TEXT NOT NULL REFERENCES jobs ON DELETE CASCADE,
  piece INTEGER NOT NULL,                   -- SQLite takes no value beyond 1e9 bytes
  bytes BLOB NOT NULL,                      -- stored_form.hpp
  PRIMARY KEY (job, piece)
) STRICT;
)sql",
    R"sql(
CREATE TABLE idempotency_keys (
  key TEXT PRIMARY KEY,
  job TEXT NOT NULL UNIQUE REFERENCES jobs ON DELETE CASCADE
) STRICT, WITHOUT ROWID;
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN trace TEXT NOT NULL DEFAULT '';  -- of the request, for the log
)sql",
    // The schema is to stay on the first page, which cannot be lost without the rest.
    R"sql(
ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';      -- the name that its token has
ALTER TABLE jobs ADD COLUMN ended INTEGER;                       -- by retention_clock.hpp
ALTER TABLE jobs ADD COLUMN damaged INTEGER NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN seal INTEGER;                        -- job_rows.hpp
UPDATE jobs SET ended = finished;
DROP INDEX jobs_by_end;
CREATE INDEX jobs_by_end ON jobs (ended, id, bytes) WHERE ended IS NOT NULL;
CREATE INDEX jobs_by_owner ON jobs (owner, id);
CREATE INDEX jobs_damaged ON jobs (id) WHERE damaged;

CREATE TABLE owned_keys (
  owner TEXT NOT NULL,
  key TEXT NOT NULL,
  job TEXT NOT NULL UNIQUE REFERENCES jobs ON DELETE CASCADE,
  PRIMARY KEY (owner, key)
) STRICT, WITHOUT ROWID;
INSERT INTO owned_keys SELECT '', key, job FROM idempotency_keys;
DROP TABLE idempotency_keys;
ALTER TABLE owned_keys RENAME TO idempotency_keys;

CREATE TABLE state (
  one INTEGER PRIMARY KEY CHECK (one = 1),
  ended_bytes INTEGER NOT NULL,             -- of all jobs that have ended
  retention INTEGER NOT NULL,               -- retention_clock.hpp
  wall INTEGER NOT NULL
) STRICT;
)sql",
    // `jobs.tags` is what is sealed; `job_tags` follows from it. When a damaged file is read,
    // idempotency_keys
    // are what has three texts: here tags are blobs, and a time stands between the texts.
    R"sql(
ALTER TABLE jobs ADD COLUMN tags TEXT NOT NULL DEFAULT '';       -- a JSON array; empty: none
CREATE INDEX jobs_by_title ON jobs (id, created, owner, title);  -- all that a search by title looks through

CREATE TABLE job_tags (
  tag BLOB NOT NULL,
  owner TEXT NOT NULL,
  job TEXT NOT NULL REFERENCES jobs ON DELETE CASCADE,
  PRIMARY KEY (tag, owner, job)
) STRICT, WITHOUT ROWID;
CREATE INDEX job_tags_of_all ON job_tags (tag, job);
CREATE INDEX job_tags_by_job ON job_tags (job);

CREATE TRIGGER tag_new AFTER INSERT ON jobs WHEN json_valid(NEW.tags) BEGIN
  INSERT OR IGNORE INTO job_tags SELECT CAST(value AS BLOB), NEW.owner, NEW.id FROM json_each(NEW.tags);
END;
CREATE TRIGGER tag_none AFTER UPDATE OF tags ON jobs BEGIN
  DELETE FROM job_tags WHERE job = NEW.id;
END;
)sql",
    R"sql(
ALTER TABLE jobs ADD COLUMN batch TEXT NOT NULL DEFAULT '';      -- that it is of; empty: none
CREATE INDEX jobs_by_batch ON jobs (batch, ended, status) WHERE batch <> '';

CREATE TABLE batches (
  id TEXT PRIMARY KEY,
  owner TEXT NOT NULL,
  created INTEGER NOT NULL,
  key TEXT,                                 -- of idempotency
  digest TEXT NOT NULL,                     -- of the request
  content BLOB NOT NULL                     -- stored_form.hpp: title, tags, ids of its jobs
) STRICT, WITHOUT ROWID;
CREATE INDEX batches_by_key ON batches (owner, key, created) WHERE key IS NOT NULL;

CREATE TRIGGER batch_gone AFTER DELETE ON jobs WHEN OLD.batch <> '' BEGIN
  DELETE FROM batches WHERE id = OLD.batch AND NOT EXISTS (SELECT 1 FROM jobs WHERE batch = OLD.batch);
END;
)sql"};

}  // namespace

int schema_version() {
  return static_cast<int>(steps.size());
}

void migrate(SQLite::Database& database, int version) {
  const int found = database.execAndGet("PRAGMA user_version").getInt();
  if (found > schema_version()) {
    throw CannotOpenStore(
        "the jobs in the data directory were written by a newer version of the service "
        "(tables of version " +
        std::to_string(found) + ", known are those up to " + std::to_string(schema_version()) +
        "); run that version, or take another directory (--data-dir)");
  }
  for (int step = found; step < version; ++step) {
    SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
    database.exec(steps.at(static_cast<std::size_t>(step)));
    database.exec("PRAGMA user_version = " + std::to_string(step + 1));
    transaction.commit();
  }
}

}  // namespace signorini::server
