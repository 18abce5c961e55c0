// What RFC 9110 and RFC 9112 ask of a server, as a table: bytes in, statuses out, and whether the connection
// goes on.
//
// Of what they recommend (SHOULD), this is left, and why:
// - A connection of HTTP/1.0 is closed after its reply, also if it asked to be kept (RFC 9112, 9.3): who
// needs it
//   kept speaks HTTP/1.1.
// - Identical values of a repeated Content-Length are refused, not merged (RFC 9112, 6.3): a proxy may have
// merged
//   others.
// - Range is ignored (RFC 9110, 14.2 allows it): what may be large is made as it is sent.
// - A trailer with a bad Content-Length or Transfer-Encoding is refused, not dropped (RFC 9110, 6.5.1):
// nobody means
//   well by it.

#include "conformance_cases.hpp"
#include "raw_client.hpp"
#include "reply_reader.hpp"
#include "running_service.hpp"

namespace signorini::server::conformance_test {
namespace {

using namespace std::chrono_literals;

class Conformance : public testing::TestWithParam<CaseGroup> {
 protected:
  static void SetUpTestSuite() {
    ServiceOptions options;
    options.limits.max_unknowns = 1'000'000;
    service = std::make_unique<RunningService>(options);
  }
  static void TearDownTestSuite() { service.reset(); }

  static std::unique_ptr<RunningService> service;
};

std::unique_ptr<RunningService> Conformance::service;

/// What a connection says, until so many replies have come or it is closed.
std::vector<Reply> replies_of(std::vector<RawClient>& client, std::size_t count, bool head) {
  listen_until(client, 60s,
               [&] { return client[0].closed() || read_replies(client[0].heard(), head).size() >= count; });
  return read_replies(client[0].heard(), head);
}

std::vector<int> statuses_of(const std::vector<Reply>& replies) {
  std::vector<int> statuses;
  for (const Reply& reply : replies) statuses.push_back(reply.status);
  return statuses;
}

TEST_P(Conformance, IsAsTheRfcsSay) {
  for (const Case& each : GetParam().cases) {
    SCOPED_TRACE(each.name);
    const bool head = each.bytes.starts_with("HEAD ");
    std::vector<RawClient> client;
    client.emplace_back(service->port());
    client[0].send(each.bytes);
    if (!each.then.empty()) {
      replies_of(client, 1, head);
      client[0].send(each.then);
    }
    std::vector<int> expected = each.statuses;
    replies_of(client, expected.size(), head);
    if (each.after == After::goes_on) {
      // Another request is understood, and is the next one.
      client[0].send("GET /readyz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
      expected.push_back(200);
    }
    const std::vector<Reply> replies = replies_of(client, 100, head);
    EXPECT_EQ(statuses_of(replies), expected) << client[0].heard();
    EXPECT_TRUE(client[0].closed());
    if (each.after == After::goes_on) {
      EXPECT_NE(client[0].heard().find("\"ready\""), std::string::npos);
    }
    EXPECT_NE(client[0].heard().find(each.says), std::string::npos) << each.says << client[0].heard();
    for (const Reply& reply : replies) {
      const bool dated = reply.head.find("\r\nDate: ") != std::string::npos;
      EXPECT_TRUE(dated || reply.status < 200) << reply.head;
    }
    if (each.after == After::closes && !replies.empty()) {
      EXPECT_NE(replies.back().head.find("\r\nConnection: close"), std::string::npos) << replies.back().head;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, Conformance, testing::ValuesIn(case_groups()),
                         [](const auto& group) { return group.param.name; });

TEST(ConformanceCases, AreTwoHundredAtLeast) {
  std::size_t count = 0;
  for (const CaseGroup& group : case_groups()) count += group.cases.size();
  EXPECT_GE(count, 200u);
}

}  // namespace
}  // namespace signorini::server::conformance_test
