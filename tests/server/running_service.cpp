#include "running_service.hpp"

#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "postgres_server.hpp"
#include "server/jobs/memory_store.hpp"
#include "server/jobs/postgres/store.hpp"
#include "server/jobs/sqlite_store.hpp"

namespace signorini::server {

namespace {

/// Whether tests of the service are to keep jobs in PostgreSQL in place of the memory.
bool on_postgres() {
  return std::getenv("SIGNORINI_TEST_POSTGRES") != nullptr;
}

std::unique_ptr<JobStore> open_store(const ServiceOptions& options) {
  const StoreLimits limits{options.queue_limit, std::size_t{1} << 30, std::chrono::hours(1)};
  if (options.data_dir.empty() && on_postgres())
    return std::make_unique<postgres::Store>(empty_database(), limits);
  if (options.data_dir.empty()) return std::make_unique<MemoryStore>(limits);
  return std::make_unique<SqliteStore>(options.data_dir, limits, options.vfs);
}

}  // namespace

RunningService::RunningService(const ServiceOptions& options)
    : store_(open_store(options)),
      scheduler_(*store_, scripted_solve, options.workers, options.max_memory,
                 [this](const Job& job, const Ending& ending) { metrics_.ended(job, ending); }),
      events_(options.max_subscribers),
      access_{options.token_file.empty() ? BearerTokens() : BearerTokens(options.token_file),
              RequestRate(options.rate), Cors(options.cors_origins), options.hosts},
      service_{*store_, scheduler_, events_, access_, options.limits, operators_, metrics_},
      router_(routes(service_)),
      listener_({"127.0.0.1", 0, options.threads, options.limits.max_body_bytes}, router_) {
  listener_.start([] { ADD_FAILURE() << "the listener ended by itself"; });
}

void RunningService::stop() {
  scheduler_.stop();
  events_.stop();
  listener_.stop();
}

ServiceTest::ServiceTest(const ServiceOptions& options)
    : service_(options), client_("127.0.0.1", service_.port()) {
  client_.set_keep_alive(true);
  client_.set_tcp_nodelay(true);
  client_.set_read_timeout(20);
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
  for (int i = 0; i < 500; ++i) {
    document = status_of(id);
    if (document.at("status") == status) return document;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  ADD_FAILURE() << "not " << status << ": " << document.dump();
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
  const timeval patience{1, 0};
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
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
  }
  ::close(socket);
  return reply;
}

}  // namespace signorini::server
