#include "server/jobs/lookout.hpp"

#include <future>

#include <gtest/gtest.h>

namespace signorini::server::lookout_test {
namespace {

using namespace std::chrono_literals;

/// In which one job has ended after two iterations, and nothing else happens.
class EndedElsewhere : public Fleet {
 public:
  std::vector<Found> look(std::span<const Sought> sought) const override {
    std::vector<Found> all;
    for (const Sought& each : sought)
      all.push_back(
          {each.job, JobStatus::succeeded, 1, Time(1s), {{}, std::vector<Iteration>(2 - each.known)}});
    return all;
  }
  bool wait_for_hint(std::chrono::milliseconds) override { return false; }
  void hint() override {}

  std::optional<Claim> claim(const Wish&) override { return std::nullopt; }
  std::chrono::milliseconds lease() const override { return 1s; }
  std::vector<Standing> renew(std::span<const Heartbeat>) override { return {}; }
  void rescue() override {}
  bool split(const Claim&, std::span<const NewChunk>) override { return false; }
  std::vector<ChunkStanding> chunks(const std::string&) const override { return {}; }
  std::optional<Claim> claim_chunk(const std::string&) override { return std::nullopt; }
  std::vector<SweepEntry> entries(const std::string&) const override { return {}; }
  std::uint64_t stale_writes() const override { return 0; }
};

/// Somebody else here may tell of its end at that moment, and those who watch it tell what is there.
TEST(Lookout, ShowsASolveWithAllThatIsKnownOfIt) {
  EndedElsewhere fleet;
  std::promise<std::size_t> shown;
  bool is_shown = false;
  LookoutEars ears;
  ears.sought = [] { return std::vector<std::string>{"a"}; };
  ears.begun = [&](const std::string&, const std::shared_ptr<const LiveSolve>& live) {
    if (!std::exchange(is_shown, true)) shown.set_value(live->history().size());
  };
  ears.ended = [](const std::string&) {};
  ears.queued = [] {};
  const Lookout lookout(fleet, ears);
  EXPECT_EQ(shown.get_future().get(), 2u);
}

}  // namespace
}  // namespace signorini::server::lookout_test
