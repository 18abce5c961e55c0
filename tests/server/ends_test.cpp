// The service ends when it should, whatever runs, and whoever does not read its log.

#include "running_service.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "api/examples.hpp"
#include "child_process.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/signals.hpp"
#include "store_jobs.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::ends_test {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr auto soon = sanitized ? 10s : 1s;

/// Its contact complement, a dense matrix of four thousand unknowns a side, takes seconds.
json long_problem() {
  json problem = json::parse(problem_titled("long"));
  problem["domain"] = {{"type", "rectangle"}, {"size", {1000, 1}}};
  problem["mesh"] = {{"divisions", {sanitized ? 1000 : 2000, 2}}};
  problem["boundary"] = {
      {"bottom", {{"type", "contact"}}}, {"top", {{"type", "contact"}}}, {"left", {{"type", "fixed"}}}};
  problem["solver"] = {{"method", "active_set"}};
  return problem;
}

void wait_for_line(const ChildProcess& process, const std::string& line) {
  for (int i = 0; i < 3000 && process.standard_error().find(line) == std::string::npos; ++i)
    std::this_thread::sleep_for(10ms);
  EXPECT_NE(process.standard_error().find(line), std::string::npos) << process.standard_error();
}

TEST(Ends, WithinItsTimeWhateverRuns) {
  const TemporaryDirectory directory;
  const std::vector<std::string> flags{"--data-dir", directory.path(), "--drain-seconds", "2"};
  std::string id;
  {
    Daemon daemon(flags);
    httplib::Client client("127.0.0.1", daemon.port());
    id = json::parse(client.Post("/v1/solves", long_problem().dump(), "application/json")->body).at("id");
    wait_for_line(daemon.process(), "job=" + id + " started");
    const auto begin = Clock::now();
    daemon.process().signal(SIGTERM);
    EXPECT_EQ(daemon.process().wait(60s), 0);
    EXPECT_LT(Clock::now() - begin, 2s + soon);
  }
  // Unless it was solved in time, it goes on.
  Daemon daemon(flags);
  httplib::Client client("127.0.0.1", daemon.port());
  EXPECT_EQ(client.Get("/v1/solves/" + id)->status, 200);
}

/// A job that does not hear that it is cancelled.
TEST(Scheduler, LeavesWhatDoesNotEndToTheNextProcess) {
  std::atomic<bool> begun = false, let_go = false;
  MemoryStore store({4, plenty, std::chrono::hours(1)});
  Scheduler scheduler(
      store,
      [&](const api::Request&, Observer&) -> Solution {
        begun = true;
        while (!let_go) std::this_thread::sleep_for(1ms);
        return {};
      },
      1);
  scheduler.submit(new_job("a", problem_titled("deaf")));
  // Not only until it is called running: one that is cancelled before it begins hears that.
  for (int i = 0; i < 1000 && !begun; ++i) std::this_thread::sleep_for(10ms);
  scheduler.cancel_running();
  EXPECT_FALSE(scheduler.wait_until_idle(100ms));
  scheduler.leave_running();
  EXPECT_EQ(store.find("a")->status, JobStatus::queued);
  let_go = true;
}

/// The first process of a container, which no signal ends by default, after it has taken the first one and
/// left the others. Returns in the process that started it, with its id, or 0 where that is not allowed.
pid_t start_first_process() {
  int ids[2];
  if (::pipe(ids) != 0) return 0;
  const pid_t outside = ::fork();
  if (outside == 0) {
    pid_t first = 0;
    if (::unshare(CLONE_NEWUSER | CLONE_NEWPID) == 0) first = ::fork();
    if (first == 0 && ::getpid() == 1) {
      const StopSignals signals;
      signals.wait([] {});
      signals.leave();
      for (;;) ::pause();
    }
    const ssize_t written = ::write(ids[1], &first, sizeof(first));
    int status = 0;
    ::waitpid(first, &status, 0);
    ::_exit(written > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : 0);
  }
  pid_t first = 0;
  if (::read(ids[0], &first, sizeof(first)) <= 0) first = 0;
  ::close(ids[0]);
  ::close(ids[1]);
  return first;
}

TEST(StopSignals, EndTheFirstProcessOfAContainerToo) {
  const pid_t first = start_first_process();
  if (first <= 0) GTEST_SKIP() << "no name spaces here";
  // Until it has its handlers, it is deaf to them.
  int status = -1;
  for (int i = 0; i < 500 && ::waitpid(-1, &status, WNOHANG) <= 0; ++i) {
    ::kill(first, SIGTERM);
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 128 + SIGTERM) << status;
  ::kill(first, SIGKILL);
}

/// A service whose log goes to a pipe that somebody reads until it listens.
class PipedLog : public testing::Test {
 protected:
  PipedLog() {
    const std::string announcement = "listening on http://127.0.0.1:";
    std::string log;
    while (log.find(announcement) == std::string::npos ||
           log.find('\n', log.find(announcement)) == std::string::npos) {
      pollfd entry{reader_, POLLIN, 0};
      if (::poll(&entry, 1, 60'000) != 1) throw std::runtime_error(log);
      char bytes[512];
      const ssize_t count = ::read(reader_, bytes, sizeof(bytes));
      if (count > 0) log.append(bytes, static_cast<std::size_t>(count));
      if (count <= 0) std::this_thread::sleep_for(5ms);
    }
    port_ = std::atoi(log.c_str() + log.find(announcement) + announcement.size());
  }
  ~PipedLog() override { ::close(reader_); }

  static int open_pipe(const std::string& pipe) {
    mkfifo(pipe.c_str(), 0600);
    return ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  }

  /// Each leaves a line in the log.
  void expect_replies(int count) {
    httplib::Client client("127.0.0.1", port_);
    client.set_keep_alive(true);
    client.set_read_timeout(10);
    const std::string path = "/v1/solves?after=" + std::string(150, 'x');
    for (int i = 0; i < count; ++i) ASSERT_TRUE(client.Get(path)) << "no reply to request " << i;
  }

  void expect_end() {
    process_.signal(SIGTERM);
    EXPECT_EQ(process_.wait(20s), 0);
  }

  const TemporaryDirectory directory_;
  const std::string pipe_ = directory_.path() + "/pipe";
  const int reader_ = open_pipe(pipe_);
  ChildProcess process_{{"--port", "0", "--data-dir", ":memory:", "--log-level", "debug"},
                        {},
                        {"sh", "-c", "exec \"$@\" 2> " + pipe_, "sh"}};
  int port_ = 0;
};

TEST_F(PipedLog, ThatNobodyReadsHoldsNoRequest) {
  // Well beyond what a pipe holds, and beyond what is kept.
  expect_replies(6000);
  expect_end();
}

/// As a collector of logs does that is started anew.
TEST_F(PipedLog, WhoseReaderLeavesEndsNothing) {
  const int nobody = ::open("/dev/null", O_RDONLY);
  ::dup2(nobody, reader_);
  ::close(nobody);
  expect_replies(10);
  expect_end();
}

TEST(Ports, ThatKubernetesSetsForAServiceAreNone) {
  ChildProcess process({"--print-config"}, {}, {"env", "SIGNORINI_PORT=tcp://10.96.0.1:8080"});
  EXPECT_EQ(process.wait(20s), 0) << process.standard_error();
  EXPECT_NE(process.standard_output().find("port=8080"), std::string::npos) << process.standard_output();
}

}  // namespace
}  // namespace signorini::server::ends_test
