// The database, or the way to it, is in trouble; or it is reached by other ways than usual.

#include <csignal>
#include <filesystem>
#include <future>
#include <thread>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../problems/long_tests.hpp"
#include "../problems/sanitized.hpp"
#include "becomes.hpp"
#include "example_problems.hpp"
#include "lost_claim.hpp"
#include "postgres_server.hpp"
#include "replica.hpp"
#include "server/jobs/postgres/store.hpp"
#include "store_jobs.hpp"
#include "tcp_proxy.hpp"
#include "temporary_directory.hpp"

namespace signorini::server::postgres_trouble_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using postgres::Connection;
using Clock = std::chrono::steady_clock;

const StoreLimits limits{1000, plenty, std::chrono::hours(1)};
/// The URL of the same database.
std::string through(const TcpProxy& proxy, const std::string& url) {
  const std::size_t begin = url.find("@/") + 1, end = url.find('?');
  return "postgresql://signorini@127.0.0.1:" + std::to_string(proxy.port()) + url.substr(begin, end - begin);
}

TEST(PostgresTrouble, ClaimsAreRenewedAndRescuedWhileAllOtherConnectionsAreInUse) {
  const std::string url = empty_database();
  postgres::Store store(url, limits, lease_of_stores);
  store.add(new_job("a"));
  Heartbeat beat;
  beat.job = "a";
  beat.attempt = store.claim().value().attempt;
  Connection locker(url, 20s);
  locker.script("BEGIN; LOCK TABLE job_tags IN ACCESS EXCLUSIVE MODE");
  std::vector<std::future<JobPage>> readers;
  for (int i = 0; i < 20; ++i)
    readers.push_back(std::async(std::launch::async, [&] { return store.list({.tag = "t"}); }));
  std::this_thread::sleep_for(200ms);
  auto heart = std::async(std::launch::async, [&] {
    const Standing standing = store.fleet()->renew(std::span(&beat, 1)).front();
    store.fleet()->rescue();
    return standing;
  });
  EXPECT_EQ(heart.wait_for(sanitized ? 20s : 2s), std::future_status::ready);
  EXPECT_FALSE(store.trouble());
  locker.script("COMMIT");
  EXPECT_EQ(heart.get(), Standing::held);
}

/// As PostgreSQL is while its machine swaps, or is stopped. Whoever looks whether the process lives must not
/// take it for dead.
TEST(PostgresTrouble, ProbesDoNotWaitForADatabaseThatDoesNotAnswer) {
  TcpProxy proxy(shared_postgres().socket());
  const std::string direct = empty_database();
  Replica replica(through(proxy, direct));
  ASSERT_EQ(replica.get("/readyz")->status, 200);
  proxy.hold(true);
  std::vector<std::future<int>> probes;
  for (int i = 0; i < 4; ++i)
    probes.push_back(std::async(std::launch::async, [&replica] {
      httplib::Client client("127.0.0.1", replica.port());
      client.set_read_timeout(30);
      const auto reply = client.Get("/readyz");
      return reply ? reply->status : 0;
    }));
  std::this_thread::sleep_for(100ms);
  const auto asked = Clock::now();
  EXPECT_EQ(replica.get("/healthz")->status, 200);
  EXPECT_LT(Clock::now() - asked, sanitized ? 5s : 1s);
  int refused = 0;
  for (auto& probe : probes) {
    EXPECT_EQ(probe.wait_for(sanitized ? 20s : 5s), std::future_status::ready);
    refused += probe.get() == 503;
  }
  // One that comes when another has been refused asks again.
  EXPECT_GE(refused, 1);
}

TEST(PostgresTrouble, OneThatIsCutOffEndsItsSolvesAndOthersTakeThem) {
  if (!long_tests()) GTEST_SKIP() << "takes as long as a connection is waited for";
  TcpProxy proxy(shared_postgres().socket());
  const std::string direct = empty_database();
  Replica front(direct, {"--role", "front"});
  Replica cut(through(proxy, direct), {"--role", "worker", "--workers", "1"});
  const std::string id = json::parse(front.post(endless_problem().dump())->body).at("id");
  const auto says = [](Replica& replica, const std::string& words) {
    return replica.process().standard_error().find(words) != std::string::npos;
  };
  ASSERT_TRUE(becomes([&] { return says(cut, id + " started"); }));
  proxy.hold(true);
  Replica other(direct, {"--role", "worker", "--workers", "1"});
  EXPECT_TRUE(becomes([&] { return says(other, id + " started"); }, 8s));
  EXPECT_TRUE(becomes([&] { return says(cut, "the claim is lost: the database is out of reach"); }, 12s));
  EXPECT_EQ(cut.get("/healthz")->status, 200);
  proxy.hold(false);
  EXPECT_TRUE(becomes([&] { return cut.get("/readyz")->status == 200; }));
  // Whoever has it goes on, and the one that came back takes the next.
  const std::string next = json::parse(front.post(endless_problem().dump())->body).at("id");
  EXPECT_TRUE(becomes([&] { return says(cut, next + " started"); }));
  EXPECT_FALSE(says(other, "the claim is lost"));
}

TEST(PostgresTrouble, OfSeveralHostsTheOneThatTakesWritesIsFound) {
  if (!long_tests()) GTEST_SKIP() << "starts servers";
  PostgresServer first, second;
  const std::string url = first.new_database("jobs");
  postgres::Store(second.new_database("jobs"), limits, lease_of_stores).count();
  postgres::Store store("postgresql://signorini@/jobs?host=" + first.directory() + "," + second.directory(),
                        limits, lease_of_stores);
  store.add(new_job("a"));
  Connection(first.url("postgres"), 5s).script("ALTER SYSTEM SET default_transaction_read_only = on");
  Connection(first.url("postgres"), 5s).script("SELECT pg_reload_conf()");
  ASSERT_TRUE(becomes([&] {
    try {
      store.add(new_job("b"));
      return store.find("b") && !store.find("a");
    } catch (const StoreUnavailable&) {
      return false;
    }
  }));
  EXPECT_FALSE(store.trouble());
}

TEST(PostgresTrouble, ADatabaseThatCannotHoldAllTextsIsRefused) {
  Connection(shared_postgres().url("postgres"), 10s)
      .script("CREATE DATABASE latin ENCODING 'LATIN1' TEMPLATE template0");
  EXPECT_THROW(postgres::Store(shared_postgres().url("latin"), limits), CannotOpenStore);
}

TEST(PostgresTrouble, TextsWithoutMeaningDoNoHarm) {
  postgres::Store store(empty_database(), limits, lease_of_stores);
  NewJob job = new_job("a");
  job.title = std::string("a\0b", 3);
  job.tags = {"\"}',{\\", "NULL", "ü"};
  job.owner = "o'\"wner";
  store.add(job);
  EXPECT_EQ(store.find("a")->title,
            "a\uFFFD"
            "b");
  EXPECT_EQ(store.find("a")->tags, job.tags);
  for (const std::string& tag : job.tags) EXPECT_EQ(store.list({.tag = tag}).jobs.size(), 1u) << tag;
  const std::vector<Sought> sought{{"\xff"}, {std::string("a\0", 2)}, {"'); DROP TABLE jobs"}, {"a"}};
  EXPECT_EQ(store.fleet()->look(sought).size(), 1u);
}

/// A server that asks everybody who comes by TLS for a certificate, and lets nobody else in.
class TlsServer {
 public:
  TlsServer()
      : server_({"listen_addresses=127.0.0.1"}, free_port(port_)), database_(server_.new_database("jobs")) {
    make("authority",
         "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=authority "
         "-keyout authority.key -out authority.crt");
    make("other",
         "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 2 -subj /CN=other "
         "-keyout other.key -out other.crt");
    sign("server", "localhost");
    sign("client", "signorini");
    for (const char* name : {"server.key", "server.crt", "authority.crt"})
      std::filesystem::copy_file(file(name), server_.directory() + "/" + name);
    struct stat owner {};
    ::stat(server_.directory().c_str(), &owner);
    EXPECT_EQ(::chown((server_.directory() + "/server.key").c_str(), owner.st_uid, owner.st_gid), 0);
    Connection(server_.url("postgres"), 10s)
        .script("COPY (SELECT 'local all all trust' UNION ALL SELECT 'hostssl all all all cert') TO '" +
                server_.directory() + "/data/pg_hba.conf'");
    for (const auto& [setting, name] : {std::pair{"ssl_key_file", "server.key"},
                                        {"ssl_cert_file", "server.crt"},
                                        {"ssl_ca_file", "authority.crt"}})
      Connection(server_.url("postgres"), 10s)
          .script("ALTER SYSTEM SET " + std::string(setting) + " = '" + server_.directory() + "/" + name +
                  "'");
    Connection(server_.url("postgres"), 10s).script("ALTER SYSTEM SET ssl = on");
    Connection(server_.url("postgres"), 10s).script("SELECT pg_reload_conf()");
  }

  std::string url(const std::string& parameters) const {
    return "postgresql://signorini@127.0.0.1:" + std::to_string(port_) + "/jobs?" + parameters;
  }
  std::string file(const std::string& name) const { return directory_.path() + "/" + name; }
  postgres::Rows ask(const std::string& sql) const { return Connection(database_, 10s).run(sql); }

 private:
  static int free_port(int& port) {
    const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(address);
    ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size);
    ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size);
    ::close(socket);
    return port = ntohs(address.sin_port);
  }
  void make(const std::string& what, const std::string& arguments) const {
    const std::string command = "cd " + directory_.path() + " && openssl " + arguments + " 2> openssl.log";
    EXPECT_EQ(std::system(command.c_str()), 0) << what;
  }
  void sign(const std::string& name, const std::string& subject) const {
    make(name, "req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -subj /CN=" + subject + " -keyout " +
                   name + ".key -out " + name +
                   ".csr && printf subjectAltName=IP:127.0.0.1 > names && openssl x509 -req "
                   "-days 2 -CA authority.crt -CAkey authority.key -CAcreateserial -extfile names -in " +
                   name + ".csr -out " + name + ".crt");
  }

  const TemporaryDirectory directory_;
  int port_ = 0;
  PostgresServer server_;
  const std::string database_;
};

TEST(PostgresTrouble, TheDatabaseIsReachedByTlsAsTheUrlSays) {
  if (!long_tests()) GTEST_SKIP() << "starts servers";
  const TlsServer server;
  const std::string verified = "sslmode=verify-full&sslrootcert=" + server.file("authority.crt");
  const std::string as_client =
      "&sslcert=" + server.file("client.crt") + "&sslkey=" + server.file("client.key");
  ASSERT_TRUE(becomes([&] {
    try {
      postgres::Store(server.url(verified + as_client), limits, lease_of_stores).count();
      return true;
    } catch (const CannotOpenStore&) {
      return false;  // it reads its configuration a moment later
    }
  }));
  postgres::Store store(server.url(verified + as_client), limits, lease_of_stores);
  store.add(new_job("a"));
  EXPECT_EQ(store.claim().value().job.id, "a");
  EXPECT_EQ(server.ask("SELECT FROM pg_stat_ssl JOIN pg_stat_activity USING (pid) "
                       "WHERE ssl AND client_dn = '/CN=signorini' AND application_name = 'signorinid'")
                    .size() > 0,
            true);
  const auto refusal = [&](const std::string& parameters) -> std::string {
    try {
      postgres::Store(server.url(parameters), limits, lease_of_stores).count();
    } catch (const CannotOpenStore& refused) {
      return refused.what();
    }
    return "taken";
  };
  EXPECT_NE(refusal("sslmode=verify-full&sslrootcert=" + server.file("other.crt") + as_client)
                .find("certificate verify failed"),
            std::string::npos);
  EXPECT_NE(refusal(verified).find("client certificate"), std::string::npos);
  EXPECT_NE(refusal("sslmode=disable").find("pg_hba.conf"), std::string::npos);
}

}  // namespace
}  // namespace signorini::server::postgres_trouble_test
