#include "server/jobs/postgres/leases.hpp"

#include <algorithm>
#include <map>

#include <spdlog/spdlog.h>

#include "server/jobs/boot_time.hpp"
#include "server/jobs/postgres/rows.hpp"
#include "server/jobs/postgres/turns.hpp"
#include "server/jobs/stored_form.hpp"
#include "server/log.hpp"

namespace signorini::server::postgres {
namespace {

constexpr int attempts_allowed = 3;

std::string hexadecimal(const std::string& bytes) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "\\x";
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    text += {digits[byte >> 4], digits[byte & 15]};
  }
  return text;
}

template <class Range, class Projection>
std::vector<std::string> texts(const Range& range, const Projection& projection) {
  std::vector<std::string> all;
  for (const auto& each : range) all.push_back(projection(each));
  return all;
}

/// Appends what a piece, which begins behind `first` iterations, has beyond those that are there: after
/// `known` others.
void append_piece(const std::vector<Iteration>& piece, std::int64_t first, std::int64_t known,
                  std::vector<Iteration>& iterations) {
  const std::int64_t there = known + std::ssize(iterations), skip = there - first;
  if (skip < 0 || skip >= std::ssize(piece)) return;
  iterations.insert(iterations.end(), piece.begin() + skip, piece.end());
}

}  // namespace

Ending attempts_used_up() {
  Ending ending;
  ending.error = ProblemDetails{
      "attempts-used-up", "Services died while they solved the problem",
      std::to_string(attempts_allowed) +
          " died or lost the database while this solve ran, and none tries it again. Most often a machine "
          "has too "
          "little memory for it (POST /v1/validate estimates it): take a coarser mesh or fewer workers."};
  return ending;
}

std::optional<Claim> Leases::claim(const Wish& wish) {
  static const std::string fits = "memory <= $2 AND " + within_share;
  // Who comes at the same time takes the next one. One statement, so that nobody can be stopped within it.
  static const std::string sql =
      // One whose operator is at hand, unless another of its owner is more urgent.
      "WITH near AS (SELECT job, turn FROM queue WHERE mark = ANY($3::bigint[]) AND mark <> 0 AND turn < " +
      turn_now + " + $5::float8 AND " + fits +
      " AND NOT EXISTS (SELECT FROM queue AS other WHERE other.owner = queue.owner AND other.priority > "
      "queue.priority) ORDER BY turn, job LIMIT 1 FOR UPDATE SKIP LOCKED), "
      // Else whose turn it is, and the most urgent one of that owner.
      "head AS (SELECT job, turn, owner FROM queue WHERE NOT EXISTS (SELECT FROM near) AND " +
      fits +
      " ORDER BY turn, job LIMIT 1 FOR UPDATE SKIP LOCKED), "
      "best AS (SELECT job, turn FROM queue WHERE owner = (SELECT owner FROM head) AND " +
      fits +
      " ORDER BY priority DESC, job LIMIT 1 FOR UPDATE SKIP LOCKED), "
      "first AS (SELECT job, turn FROM near UNION ALL SELECT best.job, head.turn FROM best, head), "
      // Else what is large would wait for as long as there is anything small.
      "next AS (DELETE FROM queue USING first WHERE queue.job = first.job AND NOT EXISTS "
      "(SELECT FROM queue WHERE turn < first.turn - $5::float8 AND memory > $2 AND memory <= $4::float8 "
      "AND " +
      within_share +
      ") RETURNING queue.job, first.turn), "
      // Whose turn was taken has that of the one who took it.
      "changed AS (UPDATE queue SET turn = best.turn FROM head, best, next WHERE queue.job = head.job AND "
      "head.job <> best.job), "
      "claimed AS (UPDATE jobs SET status = 'running', started = clock_ms(), attempt = attempt + 1, "
      "turn = next.turn FROM next WHERE id = next.job RETURNING " +
      job_columns +
      ", attempt, memory, share), "
      "lease AS (INSERT INTO leases (job, attempt, until, owner, memory) "
      "SELECT id, attempt, started + $1::bigint, owner, memory FROM claimed) "
      "SELECT " +
      job_columns + ", attempt, text, memory, share FROM claimed LEFT JOIN problems ON job = id";
  const Values values(lease_.count(), wish.memory,
                      texts(wish.operators, [](std::int64_t mark) { return std::to_string(mark); }),
                      wish.most_memory, turns_of_passing);
  Rows rows = database_.run(sql, values);
  // Others, who came later, may have taken all that was there when this one looked, but not what they saw
  // only.
  for (int again = 0; rows.empty() && again < 3; ++again) {
    if (database_.run("SELECT FROM queue LIMIT 1").empty()) break;
    rows = database_.run(sql, values);
  }
  if (rows.empty()) return std::nullopt;
  Claim claim{job_of(rows, 0), problem_of(rows.text(0, job_column_count + 1)),
              static_cast<std::uint64_t>(rows.integer(0, job_column_count)),
              rows.number(0, job_column_count + 2)};
  const int share = job_column_count + 3;
  if (!rows.is_null(0, share) && !keep_within(claim, rows.number(0, share))) return std::nullopt;
  return claim;
}

/// Gives a claim back if the claims of its owner take more than his share together: those of others who came
/// at the same time were not seen. One after the other looks, so that not all of them give back.
bool Leases::keep_within(const Claim& claim, double share) {
  return database_.with([&](Connection& connection) {
    Transaction transaction(connection);
    connection.lock("share of " + claim.job.owner);
    const Rows taken = connection.run("SELECT sum(memory) > $2 FROM leases WHERE owner = $1",
                                      Values(claim.job.owner, share));
    const bool is_beyond = !taken.is_null(0, 0) && taken.boolean(0, 0);
    const bool is_kept = !is_beyond || !give_back(connection, claim);
    transaction.commit();
    return is_kept;
  });
}

bool Leases::give_back(Connection& connection, const Claim& claim) {
  static const std::string sql =
      "WITH held AS (DELETE FROM leases WHERE job = $1 AND attempt = $2 AND NOT cancel_asked RETURNING job), "
      "pieces AS (DELETE FROM results USING held WHERE results.job = held.job), "
      "again AS (UPDATE jobs SET status = 'queued', started = NULL, given_back = given_back + 1 FROM held "
      "WHERE id = held.job RETURNING id, turn, owner, batch, memory, share, mark, priority) "
      "INSERT INTO queue (job, turn, owner, batch, memory, share, mark, priority) SELECT * FROM again "
      "RETURNING job";
  return !connection.run(sql, Values(claim.job.id, claim.attempt)).empty();
}

bool Leases::give_back(const Claim& claim) {
  if (database_.with([&](Connection& connection) { return give_back(connection, claim); })) return true;
  const Rows held = database_.run("SELECT FROM leases WHERE job = $1 AND attempt = $2",
                                  Values(claim.job.id, claim.attempt));
  if (held.empty()) refuse();
  return false;
}

std::vector<Standing> Leases::renew(std::span<const Heartbeat> heartbeats) {
  std::vector<Standing> standings(heartbeats.size(), Standing::lost);
  if (heartbeats.empty()) return standings;
  std::map<std::string, std::size_t> places;
  const auto each = [&](const auto& of) { return texts(heartbeats, of); };
  for (std::size_t i = 0; i < heartbeats.size(); ++i) places[heartbeats[i].job] = i;
  const Values values(
      lease_.count(), each([](const Heartbeat& beat) { return beat.job; }),
      each([](const Heartbeat& beat) { return std::to_string(beat.attempt); }),
      each([](const Heartbeat& beat) { return hexadecimal(pack_progress(beat.advance.progress)); }),
      each([](const Heartbeat& beat) { return std::to_string(beat.told); }),
      each([](const Heartbeat& beat) { return std::to_string(beat.advance.iterations.size()); }),
      each([](const Heartbeat& beat) { return hexadecimal(pack_iterations(beat.advance.iterations)); }));
  static const std::string sql =
      "WITH beats AS (SELECT * FROM unnest($2::text[], $3::bigint[], $4::bytea[], $5::integer[], "
      "$6::integer[], "
      "$7::bytea[]) AS beat (job, attempt, state, told, count, iterations)), "
      "renewed AS (UPDATE leases SET until = clock_ms() + $1::bigint, state = beats.state FROM beats "
      "WHERE leases.job = beats.job AND leases.attempt = beats.attempt RETURNING leases.job, cancel_asked), "
      "told AS (INSERT INTO progress SELECT beats.job, attempt, told, count, iterations FROM beats JOIN "
      "renewed "
      "USING (job) WHERE count > 0 ON CONFLICT (job, attempt, first) DO UPDATE SET count = excluded.count, "
      "iterations = excluded.iterations) "
      "SELECT beats.job, cancel_asked, jobs.attempt = beats.attempt AND finished IS NOT NULL "
      "FROM beats LEFT JOIN renewed USING (job) LEFT JOIN jobs ON id = beats.job";
  const Rows rows = with_heart([&](Connection& connection) { return connection.run(sql, values); });
  for (int row = 0; row < rows.size(); ++row) {
    Standing& standing = standings[places.at(rows.text(row, 0))];
    if (!rows.is_null(row, 1))
      standing = rows.boolean(row, 1) ? Standing::to_be_cancelled : Standing::held;
    else if (rows.is_null(row, 2) || !rows.boolean(row, 2))
      refuse();  // it has not ended under this claim
  }
  return standings;
}

/// Whether the clock of the database was set forward a moment ago: nobody has had the time to renew by it.
bool Leases::clock_jumped() {
  using Milliseconds = std::chrono::milliseconds;
  const auto asked = boot_time();
  const Milliseconds shown(
      with_heart([](Connection& connection) { return connection.run("SELECT clock_ms()"); }).integer(0, 0));
  const auto answered = boot_time();
  if (lead_ && shown - answered > *lead_ + lease_ / 2) {
    spdlog::warn("the clock of the database has jumped by {} s; claims are held for as long as ever",
                 (shown - answered - *lead_).count() / 1000);
    calm_until_ = answered + lease_;
  }
  lead_ = shown - asked;
  return answered < calm_until_;
}

void Leases::rescue() {
  if (clock_jumped()) return;
  static const std::string cancelled =
      pack_verdict(verdict_of(cancelled_ending("The solve was cancelled before it ended.")));
  static const std::string used_up = pack_verdict(verdict_of(attempts_used_up()));
  // Right after a restart of the database nobody has had the time to renew.
  static const std::string sql =
      "WITH silent AS (SELECT job FROM leases WHERE until < clock_ms() "
      "AND pg_postmaster_start_time() < clock_timestamp() - $1::bigint * interval '1 ms' "
      "LIMIT 100 FOR UPDATE SKIP LOCKED), "
      "taken AS (DELETE FROM leases USING silent WHERE leases.job = silent.job "
      "RETURNING leases.job, leases.attempt, cancel_asked), "
      "pieces AS (DELETE FROM results USING taken WHERE results.job = taken.job), "
      "judged AS (SELECT id, CASE WHEN cancel_asked THEN 'cancelled' "
      "WHEN taken.attempt - given_back >= $2::bigint THEN 'failed' ELSE 'queued' END AS verdict "
      "FROM taken JOIN jobs ON id = taken.job), "
      "moved AS (UPDATE jobs SET status = judged.verdict, "
      "started = CASE judged.verdict WHEN 'queued' THEN NULL ELSE started END, "
      "finished = CASE judged.verdict WHEN 'queued' THEN NULL ELSE clock_ms() END, "
      "verdict = CASE judged.verdict WHEN 'queued' THEN NULL WHEN 'failed' THEN $4::bytea ELSE $3::bytea END "
      "FROM judged WHERE jobs.id = judged.id RETURNING jobs.*), "
      "again AS (INSERT INTO queue (job, turn, owner, batch, memory, share, mark, priority) "
      "SELECT id, turn, owner, batch, memory, share, mark, priority FROM moved WHERE status = 'queued') "
      "SELECT id, status FROM moved";
  const Values values(lease_.count(), attempts_allowed, Bytes{cancelled}, Bytes{used_up});
  const Rows rows = with_heart([&](Connection& connection) { return connection.run(sql, values); });
  for (int row = 0; row < rows.size(); ++row) {
    const LogField job("job", rows.text(row, 0));
    spdlog::warn("its runner does not renew its claim; it is {} now", rows.text(row, 1));
  }
}

std::vector<Found> Leases::look(std::span<const Sought> asked) const {
  std::vector<Found> all;
  std::vector<Sought> sought;
  std::ranges::copy_if(asked, std::back_inserter(sought), may_be_an_id, &Sought::job);
  const Values values(texts(sought, [](const Sought& each) { return each.job; }),
                      texts(sought, [](const Sought& each) { return std::to_string(each.attempt); }),
                      texts(sought, [](const Sought& each) { return std::to_string(each.known); }),
                      texts(sought, [](const Sought& each) { return each.iterations ? "t" : "f"; }));
  // One statement, so that the state of a solve and its iterations are of one moment.
  static const std::string sql =
      "SELECT id, status, jobs.attempt, started, state, first, pieces.iterations, known_of_it FROM "
      "unnest($1::text[], $2::bigint[], $3::integer[], $4::boolean[]) "
      "AS sought (job, attempt, known, iterations) JOIN jobs ON id = sought.job "
      "LEFT JOIN leases ON leases.job = id AND leases.attempt = jobs.attempt, "
      "LATERAL (SELECT CASE jobs.attempt WHEN sought.attempt THEN known ELSE 0 END AS known_of_it) AS "
      "of_attempt "
      "LEFT JOIN LATERAL (SELECT first, progress.iterations FROM progress WHERE sought.iterations AND "
      "progress.job = id AND progress.attempt = jobs.attempt AND first + count > known_of_it) AS pieces "
      "ON true ORDER BY id, first";
  database_.with([&](Connection& connection) {
    all.clear();
    const Rows rows = connection.run(sql, values);
    for (int row = 0; row < rows.size(); ++row) {
      if (all.empty() || all.back().job != rows.view(row, 0)) {
        Found& found = all.emplace_back();
        found.job = rows.text(row, 0);
        found.status = job_status(rows.view(row, 1)).value_or(JobStatus::failed);
        found.attempt = static_cast<std::uint64_t>(rows.integer(row, 2));
        found.started = time_of(rows, row, 3);
        if (!rows.is_null(row, 4)) found.advance.progress = unpack_progress(rows.text(row, 4));
      }
      if (rows.is_null(row, 5)) continue;
      append_piece(unpack_iterations(rows.text(row, 6)), rows.integer(row, 5), rows.integer(row, 7),
                   all.back().advance.iterations);
    }
    return true;
  });
  return all;
}

void Leases::hint() {
  database_.run("NOTIFY signorini");
}

bool Leases::wait_for_hint(std::chrono::milliseconds time) {
  constexpr std::chrono::seconds patience{5};
  return database_.with_own(listener_, patience, "LISTEN signorini",
                            [&](Connection& connection) { return connection.wait_for_notification(time); });
}

}  // namespace signorini::server::postgres
