#include "server/jobs/shared_sweep.hpp"

#include <algorithm>
#include <string>

#include <spdlog/spdlog.h>
#include <nlohmann/json.hpp>

#include "server/jobs/run.hpp"

namespace signorini::server {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;

constexpr Seconds to_measure = 0.5s;  // entries are solved before the rest is judged by them
constexpr Seconds shortest_chunk = 1s;
constexpr double setups_in_a_chunk = 4;  // each worker makes the operator once, if it can keep it
constexpr double most_chunks = 64;
constexpr double most_bytes = 64e6;  // of all their problems
constexpr auto between_looks = 1s;   // at what others have done

/// Entries with which too many services died.
std::vector<SweepEntry> given_up(std::size_t count) {
  SweepEntry entry;
  entry.error =
      "services died or lost the database three times while they solved this entry and its "
      "neighbours; take a coarser mesh, or post it as a problem of its own";
  return std::vector<SweepEntry>(count, entry);
}

/// What is wrong with an entry names it by its number in the sweep that it was solved in.
void renumber(std::vector<SweepEntry>& entries, std::size_t first) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string in_chunk = "/sweep/" + std::to_string(i) + "/";
    std::string& error = entries[i].error;
    if (error.starts_with(in_chunk))
      error.replace(0, in_chunk.size(), "/sweep/" + std::to_string(first + i) + "/");
  }
}

/// The same problem with fewer entries in its sweep.
class SlicedProblem {
 public:
  explicit SlicedProblem(const std::string& problem) {
    nlohmann::json document = nlohmann::json::parse(problem);
    sweep_ = std::move(document.at("sweep"));
    for (const char* const member : {"title", "tags", "sweep"}) document.erase(member);
    rest_ = document.dump();
    rest_.pop_back();
  }

  std::size_t entries() const { return sweep_.size(); }
  std::size_t bytes_of_rest() const { return rest_.size(); }
  std::string with_entries(std::size_t first, std::size_t count) const {
    std::string text = rest_ + ",\"sweep\":[";
    for (std::size_t i = first; i < first + count; ++i) text += (i > first ? "," : "") + sweep_[i].dump();
    return text + "]}";
  }

 private:
  nlohmann::json sweep_;
  std::string rest_;  ///< without its last brace
};

/// Pieces of about so many entries that begin with a start.
std::vector<NewChunk> cut(const std::vector<std::size_t>& starts, std::size_t end, double length) {
  std::vector<NewChunk> chunks;
  for (const std::size_t start : starts)
    if (chunks.empty() || static_cast<double>(start - chunks.back().first) >= length) {
      if (!chunks.empty()) chunks.back().count = start - chunks.back().first;
      chunks.push_back({start, end - start, {}, 0});
    }
  return chunks;
}

}  // namespace

SharedSweep::SharedSweep(Fleet& fleet, JobStore& store, const Claim& claim, LiveSolve& live, SweepHost host)
    : fleet_(fleet), store_(store), claim_(claim), live_(live), host_(std::move(host)) {}

std::size_t SharedSweep::join(std::size_t next, const FindStarts& starts) {
  const auto now = Clock::now();
  try {
    if (!entries_begin_) {
      entries_begin_ = now;
      look_again_ = now + std::chrono::duration_cast<Clock::duration>(to_measure);
      const bool is_first_attempt = claim_.attempt == 1;
      if (!is_first_attempt) find_again();
    }
    if (chunks_.empty() && now >= look_again_ && next > 0) {
      look_again_ = now + (now - *entries_begin_);
      split(next, starts);
    }
  } catch (const StoreUnavailable&) {
    // Alone for now.
  }
  return chunks_.empty() ? none : chunks_.front().first;
}

/// Those of an earlier attempt.
void SharedSweep::find_again() {
  chunks_ = fleet_.chunks(claim_.job.id);
  if (!chunks_.empty()) entries_ = chunks_.back().first + chunks_.back().count;
}

/// Makes chunks of the entries from the next one on, if that is worth it.
void SharedSweep::split(std::size_t next, const FindStarts& starts) {
  const SlicedProblem problem(*claim_.problem);
  const double of_entry = Seconds(Clock::now() - *entries_begin_).count() / static_cast<double>(next);
  const double left = of_entry * static_cast<double>(problem.entries() - next);
  const double most = std::clamp(most_bytes / static_cast<double>(problem.bytes_of_rest()), 1., most_chunks);
  const double of_chunk = std::max(
      {shortest_chunk.count(), setups_in_a_chunk * Seconds(*entries_begin_ - begin_).count(), left / most});
  if (left < 2 * of_chunk) return;
  std::vector<NewChunk> chunks = cut(starts(), problem.entries(), of_chunk / of_entry);
  if (chunks.size() < 2) return;
  for (NewChunk& chunk : chunks) {
    chunk.problem = problem.with_entries(chunk.first, chunk.count);
    chunk.predicted_memory = claim_.predicted_memory.value_or(0);
  }
  if (!fleet_.split(claim_, chunks)) return;
  for (const NewChunk& chunk : chunks)
    chunks_.push_back({.job = {}, .first = chunk.first, .count = chunk.count});
  entries_ = problem.entries();
  spdlog::info("its sweep is split into {} chunks of {:.1f} s or so", chunks.size(), of_chunk);
  host_.tell();
}

std::vector<SweepEntry> SharedSweep::solve(std::size_t, const SolveEntries& here) {
  while (found_.size() < chunks_.size()) {
    if (!live_.keep_going()) throw Cancelled();
    try {
      if (const auto chunk = fleet_.claim_chunk(claim_.job.id))
        solve_chunk(*chunk, here);
      else
        gather(here);
    } catch (const StoreUnavailable&) {
      host_.wait();
    }
  }
  std::vector<SweepEntry> entries;
  for (auto& [first, found] : found_) std::ranges::move(found, std::back_inserter(entries));
  return entries;
}

/// What it finds is right, whoever has the claim by then.
void SharedSweep::solve_chunk(const Claim& claim, const SolveEntries& here) {
  const auto [whole, first, count] = *claim.job.chunk;
  host_.hold(claim);
  try {
    if (!found_.contains(first)) found_[first] = here(first, count, [this](std::size_t done) { tell(done); });
    Solution solution;
    solution.sweep = found_.at(first);
    store_.finish(claim, ending_of(std::move(solution)));
  } catch (const StoreUnavailable&) {
    // It is claimed again when the lease is over, and has been found by then.
  } catch (...) {
    give_back(claim);
    host_.let_go(claim);
    throw;
  }
  host_.let_go(claim);
}

void SharedSweep::give_back(const Claim& claim) {
  try {
    store_.give_back(claim);
  } catch (const std::exception&) {
    // Others take it when the lease is over.
  }
}

/// Takes what others have found, and solves what they could not. Waits if there is nothing.
void SharedSweep::gather(const SolveEntries& here) {
  std::map<std::size_t, ChunkStanding> standings;
  for (ChunkStanding& chunk : fleet_.chunks(claim_.job.id)) standings[chunk.first] = std::move(chunk);
  const std::size_t found_before = found_.size();
  for (const ChunkStanding& chunk : chunks_) {
    const auto standing = standings.find(chunk.first);
    const bool is_gone = standing == standings.end();
    if (found_.contains(chunk.first) || (!is_gone && !has_ended(standing->second.status))) continue;
    std::vector<SweepEntry> entries;
    if (!is_gone) entries = fleet_.entries(standing->second.job);
    renumber(entries, chunk.first);
    if (entries.size() != chunk.count && !is_gone && standing->second.is_given_up)
      entries = given_up(chunk.count);
    if (entries.size() != chunk.count)
      entries = here(chunk.first, chunk.count, [this](std::size_t done) { tell(done); });
    found_[chunk.first] = std::move(entries);
  }
  tell(0);
  if (found_.size() == found_before) host_.wait();
}

/// How many entries are done everywhere; of those that others have, as of a moment ago.
void SharedSweep::tell(std::size_t done_here) {
  const auto now = Clock::now();
  if (now - looked_ >= between_looks) {
    looked_ = now;
    try {
      done_elsewhere_ = 0;
      for (const ChunkStanding& chunk : fleet_.chunks(claim_.job.id))
        if (!found_.contains(chunk.first))
          done_elsewhere_ += has_ended(chunk.status) ? chunk.count : chunk.swept;
    } catch (const StoreUnavailable&) {
      // Later, then.
    }
  }
  std::size_t done = chunks_.front().first + done_elsewhere_ + done_here;
  for (const auto& [first, entries] : found_) done += entries.size();
  told_ = std::max(told_, std::min(done, entries_));
  live_.swept(told_, entries_);
}

}  // namespace signorini::server
