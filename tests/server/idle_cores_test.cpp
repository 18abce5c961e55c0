// Cores that no solve occupies help, and no more of them.

#include <atomic>
#include <chrono>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "server/idle_cores.hpp"

namespace signorini::server::idle_cores_test {
namespace {

void nothing() {}

void wait_a_little() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// How many are at work at once, at most.
class AtOnce {
 public:
  void begin() {
    const int now = ++now_;
    int most = most_;
    while (most < now && !most_.compare_exchange_weak(most, now)) {
    }
  }
  void end() { --now_; }
  int most() const { return most_; }

 private:
  std::atomic<int> now_ = 0, most_ = 0;
};

TEST(IdleCores, DoEachPieceOnce) {
  for (const int cores : {1, 2, 4}) {
    IdleCores idle(cores);
    const IdleCores::Solve solve(idle);
    for (const int count : {0, 1, 2, 100}) {
      std::vector<std::atomic<int>> times(count);
      idle.run(
          count, [&](int number) { ++times[number]; }, nothing);
      for (const std::atomic<int>& each : times) EXPECT_EQ(each, 1);
    }
  }
}

TEST(IdleCores, HelpOneSolve) {
  IdleCores idle(3);
  const IdleCores::Solve solve(idle);
  std::atomic<int> at_work = 0;
  // Ends only if three are at it.
  idle.run(
      3,
      [&](int) {
        ++at_work;
        while (at_work < 3) std::this_thread::yield();
      },
      nothing);
  EXPECT_EQ(at_work, 3);
}

TEST(IdleCores, OneCoreHelpsNobody) {
  IdleCores idle(1);
  const IdleCores::Solve solve(idle);
  std::set<std::thread::id> threads;
  idle.run(
      50, [&](int) { threads.insert(std::this_thread::get_id()); }, nothing);
  EXPECT_EQ(threads, std::set{std::this_thread::get_id()});
}

/// Solves and helpers together have no more than the cores, whenever solves begin and end.
TEST(IdleCores, AreNeverMoreThanThereAre) {
  constexpr int cores = 3, solves = 3;
  IdleCores idle(cores);
  AtOnce at_once;
  std::atomic<int> done = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < solves; ++i)
    threads.emplace_back([&, i] {
      for (int again = 0; again < 20; ++again) {
        std::this_thread::sleep_for(std::chrono::milliseconds((i * 7 + again * 3) % 11));
        const IdleCores::Solve solve(idle);
        idle.run(
            12,
            [&](int) {
              at_once.begin();
              wait_a_little();
              ++done;
              at_once.end();
            },
            nothing);
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(done, solves * 20 * 12);
  EXPECT_LE(at_once.most(), cores);
  EXPECT_GE(at_once.most(), 2);
}

/// It would hear no cancel meanwhile.
TEST(IdleCores, ASolveBeginsBesideALongPiece) {
  IdleCores idle(2);
  std::atomic<bool> is_at_it = false, may_end = false;
  std::thread other([&] {
    const IdleCores::Solve solve(idle);
    const auto caller = std::this_thread::get_id();
    idle.run(
        2,
        [&](int) {
          while (std::this_thread::get_id() == caller && !is_at_it) std::this_thread::yield();
          is_at_it = true;
          while (!may_end) wait_a_little();
        },
        nothing);
  });
  while (!is_at_it) wait_a_little();
  { const IdleCores::Solve begins(idle); }
  may_end = true;
  other.join();
}

TEST(IdleCores, WhoWaitsForAHelperIsCalled) {
  IdleCores idle(2);
  const IdleCores::Solve solve(idle);
  const auto caller = std::this_thread::get_id();
  std::atomic<bool> helper_is_at_it = false, was_called = false;
  idle.run(
      2,
      [&](int) {
        if (std::this_thread::get_id() == caller) {
          while (!helper_is_at_it) std::this_thread::yield();
          return;
        }
        helper_is_at_it = true;
        while (!was_called) std::this_thread::yield();
      },
      [&] { was_called = true; });
  EXPECT_TRUE(was_called);
}

/// What a piece shares is done by helpers too, and by who shares it if they are at something else.
TEST(IdleCores, PiecesMayBeSharedAgain) {
  IdleCores idle(3);
  const IdleCores::Solve solve(idle);
  std::atomic<int> done = 0;
  idle.run(
      8,
      [&](int) {
        idle.run(
            8, [&](int) { ++done; }, nothing);
      },
      nothing);
  EXPECT_EQ(done, 64);
}

}  // namespace
}  // namespace signorini::server::idle_cores_test
