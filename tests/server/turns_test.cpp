#include "server/http/turns.hpp"

#include <gtest/gtest.h>

namespace signorini::server::turns_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

class Order : public testing::Test {
 protected:
  void add(const std::string& name, const std::string& sender, Clock::time_point due = {},
           const std::function<bool()>& is_unwanted = {}) {
    turns_.add({[this, name] { done_ += name; }, sender, due, is_unwanted});
  }

  /// The names of all that wait, in the order in which they are taken.
  std::string taken() {
    done_.clear();
    while (const std::optional<Task> task = turns_.take()) task->work();
    return done_;
  }

  Turns turns_;
  std::string done_;
};

TEST_F(Order, OfOneSenderIsThatInWhichTasksComeIfAllAreDueAtOnce) {
  for (const char* name : {"a", "b", "c"}) add(name, "x");
  EXPECT_EQ(taken(), "abc");
  EXPECT_FALSE(turns_.take());
}

TEST_F(Order, GoesRoundTheSenders) {
  for (const char* name : {"1", "2", "3", "4"}) add(name, "x");
  add("a", "y");
  add("b", "y");
  add("A", "z");
  EXPECT_EQ(taken(), "1aA2b34");
}

/// Who has sent much has no turn more often than who comes later.
TEST_F(Order, GivesANewcomerOneOfTheNextTurns) {
  for (const char* name : {"1", "2", "3", "4"}) add(name, "x");
  turns_.take()->work();
  add("a", "y");
  EXPECT_EQ(turns_.take()->sender, "y");
}

TEST_F(Order, IsThatOfShorterBodiesWithinLimits) {
  const auto now = Clock::now();
  add("long", "x", due(now, 16 << 20));
  add("short ", "x", due(now + 1s, 40 << 10));
  add("later ", "x", due(now + 2s, 40 << 10));
  EXPECT_EQ(taken(), "short later long");
  add("long ", "x", due(now, 16 << 20));
  add("much later", "x", due(now + 30s, 40 << 10));
  EXPECT_EQ(taken(), "long much later");
}

TEST_F(Order, LeavesOutWhatNobodyWants) {
  add("a", "x");
  add("b", "x", {}, [] { return true; });
  add("c", "y", {}, [] { return true; });
  add("d", "z", {}, [] { return false; });
  EXPECT_EQ(turns_.take_unwanted().size(), 2u);
  EXPECT_EQ(taken(), "ad");
}

}  // namespace
}  // namespace signorini::server::turns_test
