#pragma once

// Before httplib.h, whose <resolv.h> defines `_res`, a name that Eigen uses.
#include "scripted_solve.hpp"

#include <filesystem>

#include <gtest/gtest.h>
#include <httplib.h>
#include <nlohmann/json.hpp>

#include "server/handlers/routes.hpp"
#include "server/http/listener.hpp"
#include "server/jobs/store.hpp"

namespace signorini::server {

struct ServiceOptions {
  int workers = 2;
  std::size_t queue_limit = 4;
  std::size_t threads = 16;
  std::size_t max_subscribers = 1000;
  double max_memory = std::numeric_limits<double>::infinity();
  double rate = 0;
  std::string token_file = {};
  std::vector<std::string> cors_origins = {};
  KnownHosts hosts = {};
  Limits limits{1 << 20, 1000};
  std::filesystem::path data_dir = {};  ///< empty: jobs are kept in memory
  std::string vfs = {};                 ///< the file layer of SQLite, empty for the usual one
};

/// The service on a free port of the loopback, with a scripted solver. SIGNORINI_TEST_POSTGRES=N makes it N
/// with one database, to which requests go in turns, and of which the first has the workers.
class RunningService {
 public:
  explicit RunningService(const ServiceOptions& options = {});

  int port() const { return listener_.port(); }
  /// Of the first one, if several share the jobs.
  Scheduler& scheduler() { return processes_.front()->scheduler; }
  const Router& router() const { return router_; }
  void stop();

 private:
  /// All of a service but how it is reached.
  struct Process {
    Process(const ServiceOptions& options, const std::string& database, int workers);

    std::unique_ptr<JobStore> store;
    KeptOperators operators{0};
    Metrics metrics;
    Scheduler scheduler;
    EventStreams events;
    Access access;
    Service service;
  };

  Router router_in_turns();

  std::vector<std::unique_ptr<Process>> processes_;
  std::atomic<std::size_t> requests_ = 0;
  Router router_;
  Listener listener_;
};

/// Tests through HTTP.
class ServiceTest : public testing::Test {
 protected:
  explicit ServiceTest(const ServiceOptions& options = {});

  httplib::Result get(const std::string& path) { return client_.Get(path); }
  httplib::Result post(const std::string& title, const std::string& query = {}) {
    return client_.Post("/v1/solves" + query, problem_titled(title), "application/json");
  }

  /// Posts and returns the id.
  std::string submit(const std::string& title);
  nlohmann::json status_of(const std::string& id);
  /// Waits until the job has this status, or a minute.
  nlohmann::json wait_for(const std::string& id, const std::string& status);

  RunningService service_;
  httplib::Client client_;
};

/// The body as JSON, after a check that it is a problem with this status.
nlohmann::json expect_problem(const httplib::Result& result, int status);

/// Sends the bytes as they are and returns what comes until the server closes or is silent: for a
/// second, or for a minute before it has said anything.
std::string send_raw(int port, const std::string& bytes);

}  // namespace signorini::server
