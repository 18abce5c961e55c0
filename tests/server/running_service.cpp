#include "running_service.hpp"

#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "becomes.hpp"
#include "postgres_server.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/sqlite/store.hpp"

namespace signorini::server {

namespace {

/// How many services are to share the jobs of a test by PostgreSQL; 0: one keeps them in memory.
int services_on_postgres() {
  const char* const number = std::getenv("SIGNORINI_TEST_POSTGRES");
  return number == nullptr ? 0 : std::atoi(number);
}

std::unique_ptr<JobStore> open_store(const ServiceOptions& options, const std::string& database) {
  const StoreLimits limits{options.queue_limit, std::size_t{1} << 30, std::chrono::hours(1)};
  if (!database.empty()) return std::make_unique<postgres::Store>(database, limits);
  if (options.data_dir.empty()) return std::make_unique<MemoryStore>(limits);
  return std::make_unique<SqliteStore>(options.data_dir, limits, options.vfs);
}

}  // namespace

RunningService::Process::Process(const ServiceOptions& options, const std::string& database, int workers)
    : store(open_store(options, database)),
      scheduler(*store, scripted_solve, workers, options.max_memory,
                [this](const Job& job, const Ending& ending) { metrics.ended(job, ending); }),
      events(options.max_subscribers),
      access{options.token_file.empty() ? BearerTokens() : BearerTokens(options.token_file),
             RequestRate(options.rate), Cors(options.cors_origins), options.hosts},
      service{*store, scheduler, events, access, options.limits, operators, metrics} {}

RunningService::RunningService(const ServiceOptions& options)
    : processes_([&options] {
        const bool is_fleet = options.data_dir.empty() && services_on_postgres() > 0;
        const std::string database = is_fleet ? empty_database() : "";
        std::vector<std::unique_ptr<Process>> processes;
        for (int i = 0; i < (is_fleet ? services_on_postgres() : 1); ++i)
          processes.push_back(std::make_unique<Process>(options, database, i == 0 ? options.workers : 0));
        return processes;
      }()),
      router_(router_in_turns()),
      listener_({"127.0.0.1", 0, options.threads, options.limits.max_body_bytes}, router_) {
  listener_.start([] { ADD_FAILURE() << "the listener ended by itself"; });
}

/// Each request goes to the next of the services, as by a proxy before them.
Router RunningService::router_in_turns() {
  std::vector<Router> routers;
  for (const auto& process : processes_) routers.push_back(routes(process->service));
  std::vector<Route> table = routers.front().table();
  for (std::size_t i = 0; i < table.size(); ++i) {
    std::vector<Handler> handlers;
    for (const Router& router : routers) handlers.push_back(router.table()[i].handler);
    table[i].handler = [this, handlers](const Request& request) {
      return handlers[requests_++ % handlers.size()](request);
    };
  }
  Process& first = *processes_.front();
  return {std::move(table), first.access,
          [&metrics = first.metrics](const Request& request, const Response& response,
                                     std::chrono::duration<double> time) {
            metrics.replied(request, response, time);
          }};
}

void RunningService::stop() {
  for (const auto& process : processes_) {
    process->scheduler.stop();
    process->events.stop();
  }
  listener_.stop();
}

ServiceTest::ServiceTest(const ServiceOptions& options)
    : service_(options), client_("127.0.0.1", service_.port()) {
  client_.set_keep_alive(true);
  client_.set_tcp_nodelay(true);
  client_.set_read_timeout(100);
}

std::string ServiceTest::submit(const std::string& title) {
  const httplib::Result result = post(title);
  EXPECT_TRUE(result);
  EXPECT_EQ(result->status, 202) << result->body;
  return nlohmann::json::parse(result->body).at("id");
}

nlohmann::json ServiceTest::status_of(const std::string& id) {
  const httplib::Result result = get("/v1/solves/" + id);
  EXPECT_TRUE(result);
  EXPECT_EQ(result->status, 200) << result->body;
  return nlohmann::json::parse(result->body);
}

nlohmann::json ServiceTest::wait_for(const std::string& id, const std::string& status) {
  nlohmann::json document;
  EXPECT_TRUE(becomes([&] {
    document = status_of(id);
    return document.at("status") == status;
  })) << "not "
      << status << ": " << document.dump();
  return document;
}

nlohmann::json expect_problem(const httplib::Result& result, int status) {
  if (!result) {
    ADD_FAILURE() << "no reply: " << httplib::to_string(result.error());
    return {};
  }
  EXPECT_EQ(result->status, status) << result->body;
  EXPECT_EQ(result->get_header_value("Content-Type"), "application/problem+json");
  EXPECT_FALSE(result->get_header_value("X-Request-Id").empty());
  const auto document = nlohmann::json::parse(result->body, nullptr, false);
  EXPECT_TRUE(document.is_object()) << result->body;
  if (!document.is_object()) return {};
  EXPECT_EQ(document.value("status", 0), status);
  for (const char* member : {"type", "title", "detail"}) EXPECT_NE(document.value(member, ""), "") << member;
  return document;
}

std::string send_raw(int port, const std::string& bytes) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  const auto wait_at_most = [&](int seconds) {
    const timeval patience{seconds, 0};
    setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  };
  wait_at_most(60);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ADD_FAILURE() << "cannot connect";
  }
  ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  std::string reply;
  char buffer[4096];
  for (ssize_t n = 0; (n = ::recv(socket, buffer, sizeof(buffer), 0)) > 0;) {
    reply.append(buffer, static_cast<std::size_t>(n));
    wait_at_most(1);
  }
  ::close(socket);
  return reply;
}

}  // namespace signorini::server
