#include <gtest/gtest.h>

#include "server/log.hpp"

namespace signorini::server {
namespace {

/// The log of the service, which the tests would drown in; SIGNORINI_TEST_LOG=info shows it.
class QuietLog : public testing::Environment {
 public:
  void SetUp() override {
    const char* level = std::getenv("SIGNORINI_TEST_LOG");
    start_log(level == nullptr ? "off" : level);
  }
};

[[maybe_unused]] const auto* const quiet_log = testing::AddGlobalTestEnvironment(new QuietLog);

}  // namespace
}  // namespace signorini::server
