#include "api/document/gzip.hpp"

#include <random>

#include <gtest/gtest.h>

namespace signorini::api::gzip_test {
namespace {

/// Letters that hold about six bits each.
std::string noise(std::size_t length) {
  std::mt19937 random(1);
  std::string text(length, ' ');
  for (char& c : text) c = static_cast<char>(' ' + random() % 64);
  return text;
}

TEST(Gzip, WritesWhileItReads) {
  std::size_t written = 0, largest = 0;
  const Sink sink = [&](std::string_view piece) {
    written += piece.size();
    largest = std::max(largest, piece.size());
    return true;
  };
  const std::string text = noise(1'000'000);
  Gzip gzip(sink);
  ASSERT_TRUE(gzip.put(text));
  EXPECT_GT(written, 600'000u);
  EXPECT_LE(largest, PieceWriter::piece_size);
  ASSERT_TRUE(gzip.finish());
  EXPECT_GT(written, 740'000u);
  EXPECT_LT(written, 900'000u);
}

TEST(Gzip, StopsWhenNobodyReads) {
  int pieces = 0;
  const Sink sink = [&](std::string_view) { return ++pieces < 3; };
  Gzip gzip(sink);
  EXPECT_FALSE(gzip.put(noise(1'000'000)));
  EXPECT_EQ(pieces, 3);
}

}  // namespace
}  // namespace signorini::api::gzip_test
