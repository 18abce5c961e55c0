// The service ends when it should, whatever runs, and whoever does not read its log.

#include "running_service.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "api/examples.hpp"
#include "child_process.hpp"
#include "long_tests.hpp"
#include "server/jobs/memory_store.hpp"
#include "store_jobs.hpp"
#include "temporary_directory.hpp"

namespace signorini::server {
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
  std::atomic<bool> let_go = false;
  MemoryStore store({4, plenty, std::chrono::hours(1)});
  Scheduler scheduler(
      store,
      [&](const api::Request&, Observer&) -> Solution {
        while (!let_go) std::this_thread::sleep_for(1ms);
        return {};
      },
      1);
  scheduler.submit(new_job("a", problem_titled("deaf")));
  for (int i = 0; i < 1000 && store.find("a")->status != JobStatus::running; ++i)
    std::this_thread::sleep_for(10ms);
  scheduler.cancel_running();
  EXPECT_FALSE(scheduler.wait_until_idle(100ms));
  scheduler.leave_running();
  EXPECT_EQ(store.find("a")->status, JobStatus::queued);
  let_go = true;
}

/// As the first process of a container, which no signal ends by default.
TEST(Ends, AtTheThirdSignalAlsoAsTheFirstProcess) {
  const std::vector<std::string> launcher{"unshare", "--map-root-user", "--pid", "--fork", "--kill-child"};
  ChildProcess probe({"--version"}, {}, launcher);
  if (probe.wait(20s) != 0) GTEST_SKIP() << "no name spaces here";
  Daemon daemon({"--drain-seconds", "60"}, launcher);
  const std::string parent = std::to_string(daemon.process().id());
  pid_t first = 0;
  std::ifstream("/proc/" + parent + "/task/" + parent + "/children") >> first;
  if (first == 0) GTEST_SKIP() << "cannot see the children of a process here";
  httplib::Client client("127.0.0.1", daemon.port());
  client.Post("/v1/solves", long_problem().dump(), "application/json");
  wait_for_line(daemon.process(), "started");
  ::kill(first, SIGTERM);
  wait_for_line(daemon.process(), "draining");
  ::kill(first, SIGTERM);
  wait_for_line(daemon.process(), "stopping");
  ::kill(first, SIGTERM);
  // Or by itself, once the solve hears that it is cancelled.
  const auto code = daemon.process().wait(10 * soon);
  ASSERT_TRUE(code) << "it goes on";
  EXPECT_TRUE(*code == 128 + SIGTERM || *code == 0) << *code;
}

/// A pipe for standard error of which only the beginning is read.
TEST(Log, ThatNobodyReadsHoldsNoRequest) {
  const TemporaryDirectory directory;
  const std::string pipe = directory.path() + "/pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  ChildProcess process({"--port", "0", "--data-dir", ":memory:", "--log-level", "debug"}, {},
                       {"sh", "-c", "exec \"$@\" 2> " + pipe, "sh"});
  std::string log;
  const std::string announcement = "listening on http://127.0.0.1:";
  while (log.find(announcement) == std::string::npos ||
         log.find('\n', log.find(announcement)) == std::string::npos) {
    pollfd entry{reader, POLLIN, 0};
    ASSERT_EQ(::poll(&entry, 1, 60'000), 1) << log;
    char bytes[512];
    const ssize_t count = ::read(reader, bytes, sizeof(bytes));
    if (count > 0) log.append(bytes, static_cast<std::size_t>(count));
    if (count <= 0) std::this_thread::sleep_for(5ms);
  }
  httplib::Client client("127.0.0.1", std::atoi(log.c_str() + log.find(announcement) + announcement.size()));
  client.set_keep_alive(true);
  client.set_read_timeout(10);
  // Well beyond what a pipe holds, and beyond what is kept.
  const std::string path = "/v1/solves?after=" + std::string(150, 'x');
  for (int i = 0; i < 6000; ++i) ASSERT_TRUE(client.Get(path)) << "no reply to request " << i;
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(20s), 0);
  ::close(reader);
}

TEST(Ports, ThatKubernetesSetsForAServiceAreNone) {
  ChildProcess process({"--print-config"}, {}, {"env", "SIGNORINI_PORT=tcp://10.96.0.1:8080"});
  EXPECT_EQ(process.wait(20s), 0) << process.standard_error();
  EXPECT_NE(process.standard_output().find("port=8080"), std::string::npos) << process.standard_output();
}

}  // namespace
}  // namespace signorini::server
