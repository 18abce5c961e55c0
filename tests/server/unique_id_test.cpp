#include "server/unique_id.hpp"

#include <gtest/gtest.h>

namespace signorini::server::unique_id_test {
namespace {

TEST(UniqueIds, GrowAndAreUrlSafe) {
  UniqueIds ids;
  std::string last = ids.next();
  for (int i = 0; i < 10000; ++i) {
    const std::string id = ids.next();
    ASSERT_LT(last, id);
    ASSERT_TRUE(is_unique_id(id)) << id;
    last = id;
  }
}

TEST(UniqueIds, DifferBetweenTwoSources) {
  EXPECT_NE(UniqueIds().next(), UniqueIds().next());
}

TEST(UniqueIds, TellTheirForm) {
  EXPECT_FALSE(is_unique_id(""));
  EXPECT_FALSE(is_unique_id("01M7Y4363XKD4W5Y82ZKXEYTF"));
  EXPECT_FALSE(is_unique_id("01M7Y4363XKD4W5Y82ZKXEYT/G"));
}

}  // namespace
}  // namespace signorini::server::unique_id_test
