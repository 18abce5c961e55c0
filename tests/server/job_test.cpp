#include "server/jobs/job.hpp"

#include <gtest/gtest.h>

namespace signorini::server::job_test {
namespace {

using std::chrono::milliseconds;

TEST(Iso8601, HasMillisecondsAndIsUtc) {
  EXPECT_EQ(iso8601(Time{}), "1970-01-01T00:00:00.000Z");
  EXPECT_EQ(iso8601(Time{milliseconds(1767225599007)}), "2025-12-31T23:59:59.007Z");
}

TEST(JobStatus, NamesAreReadBack) {
  for (const auto status : {JobStatus::queued, JobStatus::running, JobStatus::succeeded, JobStatus::failed,
                            JobStatus::cancelled}) {
    EXPECT_EQ(job_status(name(status)), status);
  }
  EXPECT_FALSE(job_status("done"));
}

}  // namespace
}  // namespace signorini::server::job_test
