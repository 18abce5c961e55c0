#include "running_service.hpp"

#include <sstream>
#include <thread>

#include "becomes.hpp"
#include "raw_client.hpp"

namespace signorini::server::events_test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

struct Event {
  std::string name;
  std::string id;
  json data;
};

/// The events that a client has heard whole; comments have none of these.
std::vector<Event> events_in(const std::string& heard) {
  std::vector<Event> events;
  const std::size_t head = heard.find("\r\n\r\n");
  if (head == std::string::npos) return events;
  std::size_t begin = head + 4;
  for (std::size_t end; (end = heard.find("\n\n", begin)) != std::string::npos; begin = end + 2) {
    std::istringstream lines(heard.substr(begin, end - begin));
    Event event;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("event: ")) event.name = line.substr(7);
      if (line.starts_with("id: ")) event.id = line.substr(4);
      if (line.starts_with("data: ")) event.data = json::parse(line.substr(6));
    }
    if (!event.name.empty()) events.push_back(std::move(event));
  }
  return events;
}

/// The numbers of the iterations that are told.
std::vector<int> iterations_in(const std::vector<Event>& events) {
  std::vector<int> numbers;
  for (const Event& event : events) {
    if (event.data.contains("history")) numbers.push_back(event.data.at("history").at("iteration"));
  }
  return numbers;
}

std::vector<int> from_to(int first, int last) {
  std::vector<int> numbers;
  for (int i = first; i <= last; ++i) numbers.push_back(i);
  return numbers;
}

ServiceOptions one_worker() {
  ServiceOptions options;
  options.workers = 1;
  return options;
}

class Events : public ServiceTest {
 protected:
  explicit Events(const ServiceOptions& options = one_worker()) : ServiceTest(options) {}

  RawClient subscribe(const std::string& id, const std::string& last_event_id = {}) {
    RawClient client(service_.port());
    client.send("GET /v1/solves/" + id + "/events HTTP/1.1\r\nHost: h\r\nConnection: close\r\n" +
                (last_event_id.empty() ? "" : "Last-Event-ID: " + last_event_id + "\r\n") + "\r\n");
    return client;
  }

  /// What the client has heard when the stream ends.
  std::vector<Event> all_events(RawClient client) {
    std::vector<RawClient> clients;
    clients.push_back(std::move(client));
    EXPECT_TRUE(listen_until(clients, 60s, [&] { return clients[0].closed(); }));
    EXPECT_EQ(clients[0].status(), 200) << clients[0].heard();
    return events_in(clients[0].heard());
  }

  /// What the client has heard when it leaves after so many iterations.
  std::vector<Event> some_events(RawClient client, std::size_t iterations) {
    std::vector<RawClient> clients;
    clients.push_back(std::move(client));
    EXPECT_TRUE(listen_until(
        clients, 60s, [&] { return iterations_in(events_in(clients[0].heard())).size() >= iterations; }));
    return events_in(clients[0].heard());
  }

  /// The iterations of a solve that has ended.
  int iterations_of(const std::string& id) {
    return static_cast<int>(
        json::parse(get("/v1/solves/" + id + "/history")->body).at("history").at("iteration").size());
  }
};

TEST_F(Events, TellEveryIterationAndTheEnd) {
  const std::string blocker = submit("slow");
  const std::string id = submit("short");
  RawClient client = subscribe(id);
  client_.Delete("/v1/solves/" + blocker);
  const std::vector<Event> events = all_events(std::move(client));
  EXPECT_EQ(events.back().name, "succeeded");
  const std::vector<int> told = iterations_in(events);
  ASSERT_FALSE(told.empty());
  EXPECT_EQ(told, from_to(1, told.back()));
  EXPECT_EQ(events.back().data, status_of(id));
  for (std::size_t i = 0; i + 1 < events.size(); ++i) ASSERT_EQ(events[i].name, "progress");
  EXPECT_TRUE(events.front().data.contains("phase")) << events.front().data;
}

TEST_F(Events, ShowThePhaseBeforeTheFirstIteration) {
  const std::string id = submit("slow");
  const std::vector<Event> events = some_events(subscribe(id), 3);
  ASSERT_GE(iterations_in(events).size(), 3u);
  EXPECT_EQ(events.at(0).name, "progress");
  EXPECT_EQ(iterations_in({events.at(0)}), std::vector<int>());
  EXPECT_EQ(events.back().data.at("phase"), "iterate");
  EXPECT_EQ(events.back().data.at("iteration"), events.back().data.at("history").at("iteration"));
}

TEST_F(Events, GoOnWhereTheClientLeft) {
  const std::string blocker = submit("slow");
  const std::string id = submit("short");
  RawClient early = subscribe(id);
  client_.Delete("/v1/solves/" + blocker);
  const std::vector<Event> first = some_events(std::move(early), 3);
  const std::string last = first.back().id;
  const std::vector<Event> rest = all_events(subscribe(id, last));
  wait_for(id, "succeeded");
  std::vector<int> told = iterations_in(first);
  const std::vector<int> told_later = iterations_in(rest);
  told.insert(told.end(), told_later.begin(), told_later.end());
  ASSERT_GE(told.size(), 3u);
  EXPECT_EQ(told, from_to(1, told.back()));
  EXPECT_EQ(rest.back().name, "succeeded");
}

TEST_F(Events, TellAlsoLaterWhatWasMissed) {
  const std::string id = json::parse(post("instant", "?wait=20")->body).at("id");
  const int count = iterations_of(id);
  ASSERT_GT(count, 2);
  const std::vector<Event> all = all_events(subscribe(id));
  EXPECT_EQ(iterations_in(all), from_to(1, count));
  EXPECT_EQ(all.back().name, "succeeded");
  EXPECT_EQ(iterations_in(all_events(subscribe(id, all.at(0).id))), from_to(2, count));
  // Of another run of the job: it did them all again.
  EXPECT_EQ(iterations_in(all_events(subscribe(id, "1-1"))), from_to(1, count));
  // Tells an EventSource not to come back.
  EXPECT_EQ(client_.Get("/v1/solves/" + id + "/events", {{"Last-Event-ID", all.back().id}})->status, 204);
}

TEST_F(Events, EndWithASolveThatIsCancelledWhileItWaits) {
  submit("slow");
  const std::string id = submit("instant");
  RawClient client = subscribe(id);
  std::vector<RawClient> clients;
  clients.push_back(std::move(client));
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return !events_in(clients[0].heard()).empty(); }));
  EXPECT_TRUE(events_in(clients[0].heard())[0].data.at("phase").is_null());
  client_.Delete("/v1/solves/" + id);
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return clients[0].closed(); }));
  EXPECT_EQ(events_in(clients[0].heard()).back().name, "cancelled");
}

TEST_F(Events, EndWithTheService) {
  const std::string id = submit("slow");
  std::vector<RawClient> clients;
  clients.push_back(subscribe(id));
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return !events_in(clients[0].heard()).empty(); }));
  service_.stop();
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return clients[0].closed(); }));
  EXPECT_EQ(events_in(clients[0].heard()).back().name, "cancelled");
}

TEST_F(Events, RefuseWhatTheyCannotTell) {
  expect_problem(get("/v1/solves/00000000000000000000000000/events"), 404);
  const std::string id = submit("slow");
  expect_problem(client_.Get("/v1/solves/" + id + "/events", {{"Accept", "application/json"}}), 406);
  for (const char* last : {"7", "x-7", "7-x", "7-", "-", "7-3-1"}) {
    expect_problem(client_.Get("/v1/solves/" + id + "/events", {{"Last-Event-ID", last}}), 400);
  }
}

TEST_F(Events, AreNotHeldUpByAClientThatDoesNotListen) {
  const std::string blocker = submit("slow");
  const std::string id = submit("busy");
  const RawClient deaf = subscribe(id);
  RawClient client = subscribe(id);
  std::vector<RawClient> clients;
  clients.push_back(std::move(client));
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return !events_in(clients[0].heard()).empty(); }));
  client_.Delete("/v1/solves/" + blocker);
  ASSERT_TRUE(listen_until(clients, 60s, [&] { return clients[0].closed(); }));
  const std::vector<Event> events = events_in(clients[0].heard());
  EXPECT_EQ(iterations_in(events), from_to(1, 20'000));
  EXPECT_EQ(events.back().name, "succeeded");
}

TEST_F(Events, ReachFiveHundredSubscribersWithoutTheirThreads) {
  const std::string blocker = submit("slow");
  const std::string id = submit("short");
  std::vector<RawClient> clients;
  for (int i = 0; i < 500; ++i) clients.push_back(subscribe(id));
  ASSERT_TRUE(listen_until(clients, 60s, [&] {
    return std::all_of(clients.begin(), clients.end(),
                       [](const RawClient& client) { return !events_in(client.heard()).empty(); });
  }));
  EXPECT_EQ(get("/healthz")->status, 200);
  client_.Delete("/v1/solves/" + blocker);
  ASSERT_TRUE(listen_until(clients, 60s, [&] {
    return std::all_of(clients.begin(), clients.end(),
                       [](const RawClient& client) { return client.closed(); });
  }));
  const std::vector<int> told = iterations_in(events_in(clients[0].heard()));
  ASSERT_GT(told.size(), 5u);
  EXPECT_EQ(told, from_to(1, told.back()));
  for (const RawClient& client : clients) {
    const std::vector<Event> events = events_in(client.heard());
    ASSERT_EQ(iterations_in(events), told);
    ASSERT_EQ(events.back().name, "succeeded");
  }
}

class FewEvents : public Events {
 protected:
  FewEvents() : Events(two_subscribers()) {}

  static ServiceOptions two_subscribers() {
    ServiceOptions options;
    options.max_subscribers = 2;
    return options;
  }
};

TEST_F(FewEvents, AreRefusedBeyondTheLimitUntilSomebodyLeaves) {
  const std::string id = submit("slow");
  std::vector<RawClient> clients;
  for (int i = 0; i < 2; ++i) clients.push_back(subscribe(id));
  ASSERT_TRUE(
      listen_until(clients, 60s, [&] { return clients[0].status() == 200 && clients[1].status() == 200; }));
  const auto reply = get("/v1/solves/" + id + "/events");
  const json refusal = expect_problem(reply, 503);
  EXPECT_NE(refusal.at("detail").get<std::string>().find("2 streams"), std::string::npos) << refusal;
  EXPECT_NE(refusal.at("detail").get<std::string>().find("--max-subscribers"), std::string::npos) << refusal;
  EXPECT_FALSE(reply->get_header_value("Retry-After").empty());
  clients.pop_back();
  int status = 503;
  EXPECT_TRUE(becomes([&] {
    std::vector<RawClient> next;
    next.push_back(subscribe(id));
    listen_until(next, 60s, [&] { return next[0].status() != 0; });
    status = next[0].status();
    return status != 503;
  }));
  EXPECT_EQ(status, 200);
}

/// Says nothing.
class Silent : public EventSource {
  bool next(std::string&) override { return true; }
};

TEST(EventStreams, SendCommentsInTheSilence) {
  EventStreams streams(1, 60ms);
  int sockets[2];
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, sockets), 0);
  streams.add(sockets[0], "head", std::make_shared<Silent>(), streams.open_streams().try_acquire());
  EXPECT_EQ(streams.open_streams().try_acquire(), nullptr);
  char head[4];
  ASSERT_EQ(::recv(sockets[1], head, sizeof head, MSG_WAITALL), 4);
  EXPECT_EQ(std::string(head, 4), "head");
  for (int i = 0; i < 2; ++i) {
    char comment[3];
    ASSERT_EQ(::recv(sockets[1], comment, sizeof comment, MSG_WAITALL), 3);
    EXPECT_EQ(std::string(comment, 3), ":\n\n");
  }
  ::close(sockets[1]);
}

}  // namespace
}  // namespace signorini::server::events_test
