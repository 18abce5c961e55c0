#include "server/jobs/stored_form.hpp"

#include <gtest/gtest.h>

#include "../problems/sanitized.hpp"
#include "api/examples.hpp"
#include "api/result/csv.hpp"
#include "api/result/result_document.hpp"
#include "api/result/vtu.hpp"
#include "progress/memory_meter.hpp"
#include "server/jobs/kept_operators.hpp"
#include "server/jobs/run.hpp"
#include "solution_members.hpp"
#include "store_jobs.hpp"

namespace signorini::server::stored_form_test {
namespace {

/// All that a client can ever see of a solution, in every format.
std::string everything_written(const Solution& solution) {
  std::string text;
  const api::Sink sink = [&](std::string_view piece) {
    text += piece;
    return true;
  };
  api::ResultFields fields;
  fields.problem = false;
  fields.principal = fields.von_mises = solution.components == 2;
  for (const auto format : {api::Format::json, api::Format::cbor}) {
    api::write_document(format, sink, [&](api::DocumentWriter& out) {
      api::write_result(out, {"id", "succeeded", ""}, solution, fields);
    });
  }
  api::write_vtu(solution, sink);
  api::write_history_csv(solution.history, sink);
  api::write_contact_csv(solution.contact, sink);
  return text;
}

std::string written(const Summary& summary) {
  std::string text;
  const api::Sink sink = [&](std::string_view piece) {
    text += piece;
    return true;
  };
  api::write_document(api::Format::json, sink,
                      [&](api::DocumentWriter& out) { api::write_summary(out, summary); });
  return text;
}

JobResult stored_and_read(const Ending& ending) {
  JobResult result;
  const std::string packed = pack_findings(ending);
  unpack_findings(
      [&](std::size_t offset, std::span<char> room) { return packed.copy(room.data(), room.size(), offset); },
      result);
  return result;
}

TEST(StoredForm, ServesEveryFormatAsTheSolutionDid) {
  for (const api::Example& example : api::examples()) {
    SCOPED_TRACE(example.name);
    Observer nobody;
    KeptOperators operators(0);
    IdleCores cores(2);
    Solution solution = solve_request(api::parse_request(example.json), nobody, operators, cores);
    solution.summary.reused = true;
    if (!solution.sweep.empty()) solution.sweep.back().error = "none";
    const Ending ending = ending_of(std::move(solution));
    const JobResult read = stored_and_read(ending);
    EXPECT_EQ(everything_written(*read.solution), everything_written(*ending.solution));
    // No format shows these so far.
    EXPECT_EQ(read.solution->stress, ending.solution->stress);
    EXPECT_EQ(read.solution->rotation, ending.solution->rotation);
    EXPECT_EQ(read.solution->mesh->triangle_edges, ending.solution->mesh->triangle_edges);
    EXPECT_EQ(read.solution->mesh->edge_triangles, ending.solution->mesh->edge_triangles);
    EXPECT_EQ(written(*unpack_verdict(pack_verdict(verdict_of(ending))).summary),
              written(ending.solution->summary));
  }
}

TEST(StoredForm, KeepsEveryMember) {
  Solution solution;
  Filler fill;
  fill(solution);
  const Ending ending = ending_of(std::move(solution));
  EXPECT_TRUE(are_equal(*stored_and_read(ending).solution, *ending.solution));
  EXPECT_TRUE(are_equal(*unpack_verdict(pack_verdict(verdict_of(ending))).summary, ending.solution->summary));
}

TEST(StoredForm, KeepsWhatIsNotThere) {
  Ending ending = cancelled_ending("enough");
  EXPECT_FALSE(stored_and_read(ending).solution);
  EXPECT_TRUE(stored_and_read(ending).history->empty());
  const Verdict verdict = unpack_verdict(pack_verdict(verdict_of(ending)));
  EXPECT_EQ(verdict.error->detail, "enough");
  EXPECT_FALSE(verdict.summary);
  EXPECT_FALSE(verdict.last_iteration);
}

/// There is no copy of them but the packed one.
TEST(StoredForm, IsMadeInAsMuchMemoryAsTheFindingsTakeAtMost) {
  if (sanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  Solution solution;
  solution.sweep.resize(1000);
  for (SweepEntry& entry : solution.sweep) {
    entry.contact.resize(1);
    entry.contact[0].clearance.resize(1000, 1.5);
  }
  const Ending ending = ending_of(std::move(solution));
  const MemoryMeter memory;
  const std::string packed = pack_findings(ending);
  const std::size_t size = unpacked_size([&](std::size_t offset, std::span<char> room) {
    return packed.copy(room.data(), room.size(), offset);
  });
  EXPECT_GT(size, 8'000'000);
  EXPECT_LT(memory.peak(), 1.2 * static_cast<double>(size));
}

TEST(StoredForm, SeesDamage) {
  const std::string packed = pack_text(std::string(1000, 'a') + "b");
  EXPECT_EQ(unpack_text(packed), std::string(1000, 'a') + "b");
  for (std::size_t i = 0; i < packed.size(); ++i) {
    std::string damaged = packed;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
    EXPECT_THROW(unpack_text(damaged), std::exception) << i;
    EXPECT_THROW(unpack_text(packed.substr(0, i)), std::exception) << i;
  }
}

}  // namespace
}  // namespace signorini::server::stored_form_test
