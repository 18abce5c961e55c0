#include "server/jobs/postgres/migrations.hpp"

#include <array>

#include "server/jobs/store.hpp"

namespace signorini::server::postgres {
namespace {

// A step that was ever released stays as it is; a change is a new step.
constexpr std::array steps{// Times are milliseconds since 1970 by the clock of the database, but `created`,
                           // which a client sees only.
                           R"sql(
CREATE FUNCTION clock_ms() RETURNS bigint LANGUAGE sql VOLATILE
  AS $$ SELECT (extract(epoch FROM clock_timestamp()) * 1000)::bigint $$;

CREATE TABLE jobs (
  id text COLLATE "C" PRIMARY KEY,          -- sorts by age
  status text NOT NULL,
  title text NOT NULL,
  tags text NOT NULL,                       -- a JSON array; empty: none
  owner text COLLATE "C" NOT NULL,
  batch text COLLATE "C" NOT NULL,          -- that it is of; empty: none
  trace text NOT NULL,
  created bigint NOT NULL,
  started bigint,
  finished bigint,
  attempt bigint NOT NULL DEFAULT 0,        -- of the last claim; whatever a runner writes must know it
  given_back bigint NOT NULL DEFAULT 0,     -- attempts that no dying process cut short
  turn double precision NOT NULL,           -- its place in the queue
  memory double precision NOT NULL,         -- bytes that it is predicted to take
  share double precision,                   -- bytes that those of its owner may take together
  verdict bytea,                            -- stored_form.hpp
  bytes bigint NOT NULL,                    -- of the problem and the result as stored
  damaged boolean NOT NULL DEFAULT false
);
CREATE INDEX jobs_by_status ON jobs (status, id);
CREATE INDEX jobs_by_owner ON jobs (owner, id);
CREATE INDEX jobs_by_batch ON jobs (batch, finished) WHERE batch <> '';
CREATE INDEX jobs_by_end ON jobs (finished, id) WHERE finished IS NOT NULL;

-- What changes often is narrow, and never larger than what waits or runs.
CREATE TABLE queue (
  job text COLLATE "C" PRIMARY KEY,
  turn double precision NOT NULL,
  owner text COLLATE "C" NOT NULL,
  batch text COLLATE "C" NOT NULL,
  memory double precision NOT NULL,
  share double precision
) WITH (autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000);
CREATE INDEX queue_by_turn ON queue (turn, job);
CREATE INDEX queue_by_owner ON queue (owner, turn);
CREATE INDEX queue_by_batch ON queue (batch) WHERE batch <> '';

CREATE TABLE leases (
  job text COLLATE "C" PRIMARY KEY,
  attempt bigint NOT NULL,
  until bigint NOT NULL,                    -- then anybody may take it from its runner
  owner text COLLATE "C" NOT NULL,
  memory double precision NOT NULL,
  cancel_asked boolean NOT NULL DEFAULT false,
  state bytea                               -- how far the solve is: stored_form.hpp
) WITH (fillfactor = 50, autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000);

CREATE TABLE problems (
  job text COLLATE "C" PRIMARY KEY REFERENCES jobs ON DELETE CASCADE,
  text bytea NOT NULL                       -- stored_form.hpp
);
ALTER TABLE problems ALTER COLUMN text SET STORAGE EXTERNAL;

CREATE TABLE results (
  job text COLLATE "C" NOT NULL REFERENCES jobs ON DELETE CASCADE,
  attempt bigint NOT NULL,                  -- that found it; those of others are never read
  piece integer NOT NULL,
  bytes bytea NOT NULL,                     -- stored_form.hpp
  PRIMARY KEY (job, attempt, piece)
);
ALTER TABLE results ALTER COLUMN bytes SET STORAGE EXTERNAL;

CREATE TABLE progress (
  job text COLLATE "C" NOT NULL REFERENCES jobs ON DELETE CASCADE,
  attempt bigint NOT NULL,
  first integer NOT NULL,                   -- iterations before these
  count integer NOT NULL,
  iterations bytea NOT NULL,                -- stored_form.hpp
  PRIMARY KEY (job, attempt, first)
);

CREATE TABLE batches (
  id text COLLATE "C" PRIMARY KEY,
  owner text COLLATE "C" NOT NULL,
  created bigint NOT NULL,
  digest text NOT NULL,                     -- of the request
  content bytea NOT NULL                    -- stored_form.hpp: title, tags, ids of its jobs
);
CREATE FUNCTION drop_batch() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  DELETE FROM batches WHERE id = OLD.batch AND NOT EXISTS (SELECT FROM jobs WHERE batch = OLD.batch);
  RETURN NULL;
END $$;
CREATE TRIGGER batch_gone AFTER DELETE ON jobs FOR EACH ROW WHEN (OLD.batch <> '')
  EXECUTE FUNCTION drop_batch();

CREATE TABLE idempotency_keys (
  owner text COLLATE "C" NOT NULL,
  key text COLLATE "C" NOT NULL,
  job text COLLATE "C" UNIQUE REFERENCES jobs ON DELETE CASCADE,
  batch text COLLATE "C" UNIQUE REFERENCES batches ON DELETE CASCADE,
  PRIMARY KEY (owner, key)
);

CREATE TABLE job_tags (
  tag bytea NOT NULL,
  owner text COLLATE "C" NOT NULL,
  job text COLLATE "C" NOT NULL REFERENCES jobs ON DELETE CASCADE,
  PRIMARY KEY (tag, owner, job)
);
CREATE INDEX job_tags_of_all ON job_tags (tag, job);
CREATE INDEX job_tags_by_job ON job_tags (job);

-- How many jobs there are, in rows that no two transactions of different connections wait for; the sum counts.
CREATE TABLE tallies (
  shard integer PRIMARY KEY,
  queued bigint NOT NULL DEFAULT 0,
  running bigint NOT NULL DEFAULT 0,
  succeeded bigint NOT NULL DEFAULT 0,
  failed bigint NOT NULL DEFAULT 0,
  cancelled bigint NOT NULL DEFAULT 0,
  ended_bytes bigint NOT NULL DEFAULT 0,
  damaged bigint NOT NULL DEFAULT 0
) WITH (fillfactor = 10, autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000);
INSERT INTO tallies (shard) SELECT generate_series(0, 31);

CREATE FUNCTION tally() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  was text := coalesce(OLD.status, '');
  is_now text := coalesce(NEW.status, '');
BEGIN
  UPDATE tallies SET
    queued = queued + (is_now = 'queued')::int - (was = 'queued')::int,
    running = running + (is_now = 'running')::int - (was = 'running')::int,
    succeeded = succeeded + (is_now = 'succeeded')::int - (was = 'succeeded')::int,
    failed = failed + (is_now = 'failed')::int - (was = 'failed')::int,
    cancelled = cancelled + (is_now = 'cancelled')::int - (was = 'cancelled')::int,
    ended_bytes = ended_bytes + CASE WHEN NEW.finished IS NULL THEN 0 ELSE NEW.bytes END
                              - CASE WHEN OLD.finished IS NULL THEN 0 ELSE OLD.bytes END,
    damaged = damaged + coalesce(NEW.damaged, false)::int - coalesce(OLD.damaged, false)::int
  WHERE shard = pg_backend_pid() % 32;
  RETURN NULL;
END $$;
-- At the commit, behind all other locks, so that nobody who holds one waits for something else.
CREATE CONSTRAINT TRIGGER tally AFTER INSERT OR DELETE OR UPDATE OF status, bytes, damaged ON jobs
  DEFERRABLE INITIALLY DEFERRED FOR EACH ROW EXECUTE FUNCTION tally();
)sql",
                           // Marks of operators, by which a job finds who has factored its matrix.
                           R"sql(
ALTER TABLE jobs ADD COLUMN mark bigint NOT NULL DEFAULT 0;
ALTER TABLE queue ADD COLUMN mark bigint NOT NULL DEFAULT 0;
CREATE INDEX queue_by_mark ON queue (mark, turn) WHERE mark <> 0;
)sql",
                           // That a clock which is set drops nothing.
                           R"sql(
CREATE TABLE retention_clock (
  seen bigint NOT NULL,                     -- by clock_ms() at the last sweep
  hold_until bigint NOT NULL                -- before that nothing is dropped by age
) WITH (fillfactor = 10, autovacuum_vacuum_scale_factor = 0, autovacuum_vacuum_threshold = 2000);
INSERT INTO retention_clock VALUES (clock_ms(), 0);
)sql",
                           // Priorities within an owner, and entries of a sweep that are a job of their own.
                           R"sql(
ALTER TABLE jobs ADD COLUMN priority smallint NOT NULL DEFAULT 0;
ALTER TABLE jobs ADD COLUMN step double precision NOT NULL DEFAULT 1;  -- turns that it takes
ALTER TABLE jobs ADD COLUMN chunks integer NOT NULL DEFAULT 0;         -- that its sweep was split into
-- The job whose entries these are; whoever lists jobs does not see them.
ALTER TABLE jobs ADD COLUMN whole text COLLATE "C" REFERENCES jobs ON DELETE CASCADE;
ALTER TABLE jobs ADD COLUMN first_entry integer, ADD COLUMN entries integer;
CREATE INDEX jobs_by_whole ON jobs (whole, first_entry) WHERE whole IS NOT NULL;

ALTER TABLE queue ADD COLUMN priority smallint NOT NULL DEFAULT 0;
CREATE INDEX queue_by_priority ON queue (owner, priority DESC, job);

CREATE OR REPLACE FUNCTION tally() RETURNS trigger LANGUAGE plpgsql AS $$
DECLARE
  was text := coalesce(OLD.status, '');
  is_now text := coalesce(NEW.status, '');
BEGIN
  IF coalesce(NEW.whole, OLD.whole) IS NOT NULL THEN RETURN NULL; END IF;
  UPDATE tallies SET
    queued = queued + (is_now = 'queued')::int - (was = 'queued')::int,
    running = running + (is_now = 'running')::int - (was = 'running')::int,
    succeeded = succeeded + (is_now = 'succeeded')::int - (was = 'succeeded')::int,
    failed = failed + (is_now = 'failed')::int - (was = 'failed')::int,
    cancelled = cancelled + (is_now = 'cancelled')::int - (was = 'cancelled')::int,
    ended_bytes = ended_bytes + CASE WHEN NEW.finished IS NULL THEN 0 ELSE NEW.bytes END
                              - CASE WHEN OLD.finished IS NULL THEN 0 ELSE OLD.bytes END,
    damaged = damaged + coalesce(NEW.damaged, false)::int - coalesce(OLD.damaged, false)::int
  WHERE shard = pg_backend_pid() % 32;
  RETURN NULL;
END $$;

-- However the whole ends, and whoever ends it.
CREATE FUNCTION drop_chunks() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  DELETE FROM queue USING jobs WHERE queue.job = jobs.id AND jobs.whole = NEW.id;
  DELETE FROM leases USING jobs WHERE leases.job = jobs.id AND jobs.whole = NEW.id;
  DELETE FROM jobs WHERE whole = NEW.id;
  RETURN NULL;
END $$;
CREATE TRIGGER whole_ended AFTER UPDATE OF finished ON jobs FOR EACH ROW
  WHEN (NEW.chunks > 0 AND NEW.finished IS NOT NULL) EXECUTE FUNCTION drop_chunks();
)sql"};

int version_of(Connection& connection) {
  const char* const known =
      "SELECT FROM pg_tables WHERE schemaname = current_schema() AND tablename = 'schema_version'";
  if (connection.run(known).empty()) return 0;
  return static_cast<int>(connection.run("SELECT version FROM schema_version").integer(0, 0));
}

void require_known(int version) {
  if (version <= static_cast<int>(steps.size())) return;
  throw CannotOpenStore(
      "the jobs in the database were written by a newer version of the service (tables of version " +
      std::to_string(version) + ", known are those up to " + std::to_string(steps.size()) +
      "); run that version, or take another database (--database)");
}

}  // namespace

void migrate(Connection& connection) {
  const int found = version_of(connection);
  require_known(found);
  // Then it takes no rights but those to read and write.
  if (found == static_cast<int>(steps.size())) return;
  Transaction transaction(connection);
  connection.script("SET LOCAL statement_timeout = 0");
  connection.lock("migration");
  const int version = version_of(connection);
  require_known(version);
  // Services of an earlier version go on, and everybody would wait behind a lock that has to be waited for.
  connection.script("SET LOCAL lock_timeout = '5s'");
  if (version == 0)
    connection.script(
        "CREATE TABLE schema_version (version integer NOT NULL); INSERT INTO schema_version VALUES (0)");
  for (std::size_t step = static_cast<std::size_t>(version); step < steps.size(); ++step)
    connection.script(steps[step]);
  connection.script("UPDATE schema_version SET version = " + std::to_string(steps.size()));
  transaction.commit();
}

}  // namespace signorini::server::postgres
