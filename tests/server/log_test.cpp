#include "server/log.hpp"

#include <sstream>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "server/failure.hpp"

namespace signorini::server::log_test {
namespace {

/// Writes a line; the log belongs to the service, which writes one for what nobody foresaw.
void log(const std::string& text) {
  describe(std::make_exception_ptr(std::runtime_error(text)));
}

/// The lines that are written meanwhile.
template <typename Write>
std::vector<std::string> logged(const std::string& level, const std::string& format, const Write& write) {
  testing::internal::CaptureStderr();
  start_log(level, format);
  write();
  start_log("off");
  std::istringstream text(testing::internal::GetCapturedStderr());
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  return lines;
}

void write_some() {
  log("before");
  const LogField job("job", "A");
  {
    const LogField other("job", "B"), status("status", std::int64_t{200}), ms("ms", 0.5);
    log("within");
  }
  log("a \"quoted\"\nline \xff");
}

TEST(Log, WritesFieldsBeforeTheMessage) {
  const auto lines = logged("info", "text", write_some);
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_TRUE(lines[0].ends_with("Z error nobody foresaw this failure: before")) << lines[0];
  EXPECT_TRUE(lines[1].ends_with("Z error job=B status=200 ms=0.5 nobody foresaw this failure: within"))
      << lines[1];
  EXPECT_TRUE(lines[2].ends_with("Z error job=A nobody foresaw this failure: a \"quoted\"")) << lines[2];
  EXPECT_TRUE(logged("off", "text", write_some).empty());
}

TEST(Log, WritesAnObjectALine) {
  const auto lines = logged("info", "json", write_some);
  ASSERT_EQ(lines.size(), 3u);
  const auto within = nlohmann::json::parse(lines[1]);
  EXPECT_EQ(within.at("level"), "error");
  EXPECT_EQ(within.at("message"), "nobody foresaw this failure: within");
  EXPECT_EQ(within.at("job"), "B");
  EXPECT_EQ(within.at("status"), 200);
  EXPECT_EQ(within.at("ms"), 0.5);
  EXPECT_EQ(within.at("time").get<std::string>().size(), std::string("2026-01-31T12:34:56.789Z").size());
  const auto last = nlohmann::json::parse(lines[2]);
  EXPECT_EQ(last.at("job"), "A");
  EXPECT_TRUE(last.at("message").get<std::string>().ends_with("a \"quoted\"\nline \xef\xbf\xbd"));
}

}  // namespace
}  // namespace signorini::server::log_test
