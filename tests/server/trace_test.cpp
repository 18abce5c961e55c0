#include "server/http/trace.hpp"

#include <gtest/gtest.h>

#include "running_service.hpp"

namespace signorini::server::trace_test {
namespace {

const std::string id = "0af7651916cd43dd8448eb211c80319c";
const std::string parent = "00-" + id + "-b7ad6b7169203331-01";

TEST(Trace, IsReadAndGoesOnWithAStepOfItsOwn) {
  const auto trace = read_traceparent(parent);
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->id, id);
  EXPECT_EQ(trace->flags, "01");
  EXPECT_NE(trace->span, "b7ad6b7169203331");
  EXPECT_EQ(traceparent(*trace), "00-" + id + '-' + trace->span + "-01");
  EXPECT_TRUE(read_traceparent(traceparent(*trace)));
  EXPECT_TRUE(read_traceparent("cc-" + parent.substr(3) + "-of-a-later-version"));
}

TEST(Trace, IgnoresWhatIsMalformed) {
  std::string upper = parent;
  upper[5] = 'F';
  for (const std::string& header :
       {std::string(), std::string("00"), parent.substr(1), parent + "-00", parent + "0",
        "ff" + parent.substr(2), upper, "00-" + std::string(32, '0') + parent.substr(35),
        parent.substr(0, 36) + std::string(16, '0') + "-01", "cc-" + parent.substr(3) + "x"})
    EXPECT_FALSE(read_traceparent(header)) << header;
}

TEST_F(ServiceTest, TellsTheTraceOfARequestToItsReplyAndItsJob) {
  const auto reply =
      client_.Post("/v1/solves", {{"traceparent", parent}}, problem_titled("instant"), "application/json");
  ASSERT_EQ(reply->status, 202);
  EXPECT_TRUE(reply->get_header_value("traceparent").starts_with("00-" + id + '-'));
  EXPECT_FALSE(get("/healthz")->has_header("traceparent"));
}

}  // namespace
}  // namespace signorini::server::trace_test
