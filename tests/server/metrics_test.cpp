#include <regex>
#include <sstream>

#include "running_service.hpp"

namespace signorini::server::metrics_test {
namespace {

/// The samples of a text in Prometheus's format by name and labels; a line that is none fails the test.
std::map<std::string, double> samples_of(const std::string& text) {
  static const std::regex comment("# (HELP|TYPE) [a-z_]+ .+");
  static const std::regex sample(R"(([a-z_]+(\{[a-z_]+="[^"]*"(,[a-z_]+="[^"]*")*\})?) (\S+))");
  std::map<std::string, double> samples;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (std::regex_match(line, comment)) continue;
    EXPECT_TRUE(std::regex_match(line, match, sample)) << line;
    if (match.empty()) continue;
    EXPECT_TRUE(samples.emplace(match[1], std::stod(match[4])).second) << "twice: " << line;
  }
  return samples;
}

class MetricsTest : public ServiceTest {
 protected:
  std::map<std::string, double> metrics() {
    const auto reply = get("/metrics");
    EXPECT_EQ(reply->get_header_value("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
    return samples_of(reply->body);
  }
};

TEST_F(MetricsTest, CountSolvesAndTheirPhases) {
  EXPECT_EQ(metrics().at(R"(signorini_runs_total{status="succeeded"})"), 0);
  for (const char* title : {"instant", "instant", "diverges", "no memory"}) post(title, "?wait=10");
  submit("slow");
  const std::string slow = submit("slow");
  wait_for(slow, "running");
  submit("slow");
  const auto now = metrics();
  EXPECT_EQ(now.at(R"(signorini_runs_total{status="succeeded"})"), 2);
  EXPECT_EQ(now.at(R"(signorini_runs_total{status="failed"})"), 2);
  EXPECT_EQ(now.at(R"(signorini_solves{status="succeeded"})"), 2);
  EXPECT_EQ(now.at(R"(signorini_solves{status="running"})"), 2);
  EXPECT_EQ(now.at(R"(signorini_solves{status="queued"})"), 1);
  EXPECT_EQ(now.at(R"(signorini_solve_seconds_count{phase="total"})"), 3);
  EXPECT_EQ(now.at(R"(signorini_solve_seconds_bucket{phase="factorize",le="+Inf"})"), 3);
  EXPECT_EQ(now.at(R"(signorini_solve_unknowns_count{field="stress"})"), 3);
  EXPECT_EQ(now.at("signorini_queue_seconds_count"), 4);
  EXPECT_EQ(now.at("signorini_operator_cache_hits_total"), 0);
}

TEST_F(MetricsTest, CountRepliesByRouteAndNothingThatAClientInvents) {
  const std::string id = submit("instant");
  get("/v1/solves/" + id);
  get("/v1/solves/none");
  get("/invented");
  client_.Post("/healthz", "", "text/plain");
  const auto now = metrics();
  EXPECT_EQ(now.at(R"(signorini_http_requests_total{method="GET",route="/v1/solves/{id}",status="200"})"), 1);
  EXPECT_EQ(now.at(R"(signorini_http_requests_total{method="GET",route="/v1/solves/{id}",status="404"})"), 1);
  EXPECT_EQ(now.at(R"(signorini_http_requests_total{method="none",route="none",status="404"})"), 1);
  EXPECT_EQ(now.at(R"(signorini_http_request_seconds_count{route="/v1/solves"})"), 1);
  for (const auto& [name, value] : now) EXPECT_EQ(name.find("invented"), std::string::npos) << name;
}

TEST_F(MetricsTest, TellOfTheProcess) {
  const auto now = metrics();
  EXPECT_GT(now.at("process_resident_memory_bytes"), 1e6);
  EXPECT_GE(now.at("process_virtual_memory_bytes"), now.at("process_resident_memory_bytes"));
  EXPECT_GE(now.at("process_threads"), 3);
  EXPECT_GT(now.at("process_open_fds"), 3);
  EXPECT_GE(now.at("process_max_fds"), now.at("process_open_fds"));
  const auto seconds =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  EXPECT_NEAR(now.at("process_start_time_seconds"), seconds, 3600);
  EXPECT_GE(metrics().at("process_cpu_seconds_total"), now.at("process_cpu_seconds_total"));
  EXPECT_EQ(now.at("signorini_ready"), 1);
  service_.scheduler().drain();
  EXPECT_EQ(metrics().at("signorini_ready"), 0);
}

}  // namespace
}  // namespace signorini::server::metrics_test
