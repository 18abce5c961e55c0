#include "api/document/json_writer.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "written_by.hpp"

namespace signorini::api::json_writer_test {
namespace {

double back_and_forth(double number) {
  return std::strtod(text_of([&](DocumentWriter& json) { json.value(number); }).c_str(), nullptr);
}

TEST(JsonWriter, SetsCommas) {
  const std::string text = text_of([](DocumentWriter& json) {
    json.begin_object()
        .member("a", 1)
        .key("b")
        .begin_array()
        .value(1.5)
        .value(true)
        .begin_array()
        .end_array();
    json.begin_object()
        .end_object()
        .end_array()
        .member("c", "d")
        .key("e")
        .json("{ }")
        .member("f", false)
        .end_object();
  });
  EXPECT_EQ(text, R"({"a":1,"b":[1.5,true,[],{}],"c":"d","e":{ },"f":false})");
}

TEST(JsonWriter, NestsArraysOfNumbersByTheirShape) {
  const std::vector<double> numbers{0.5, 1, -2, 3, 4, 5e-300, 6, 7, 8, 9, 10, 11};
  const auto shaped = [&](const Shape& shape) {
    return text_of([&](DocumentWriter& json) {
      json.begin_array().numbers(shape, std::span(numbers)).value(1).end_array();
    });
  };
  EXPECT_EQ(shaped({12}), "[[0.5,1,-2,3,4,5e-300,6,7,8,9,10,11],1]");
  EXPECT_EQ(shaped({4, 3}), "[[[0.5,1,-2],[3,4,5e-300],[6,7,8],[9,10,11]],1]");
  EXPECT_EQ(shaped({2, 3, 2}), "[[[[0.5,1],[-2,3],[4,5e-300]],[[6,7],[8,9],[10,11]]],1]");
  EXPECT_EQ(shaped({1, 12, 1}).substr(0, 12), "[[[[0.5],[1]");
}

TEST(JsonWriter, WritesComputedRowsAsThoseOfMemory) {
  const auto row = [](std::size_t i) { return std::array{static_cast<int>(i), -1}; };
  EXPECT_EQ(text_of([&](DocumentWriter& json) { json.rows({3, 2}, row); }), "[[0,-1],[1,-1],[2,-1]]");
  EXPECT_EQ(text_of([&](DocumentWriter& json) { json.rows({0, 2}, row); }), "[]");
  const auto number = [](std::size_t i) { return 0.5 * static_cast<double>(i); };
  EXPECT_EQ(text_of([&](DocumentWriter& json) { json.rows({3}, number); }), "[0,0.5,1]");
}

TEST(JsonWriter, EscapesStrings) {
  const std::string odd = std::string("q\" b\\ n\n r\r t\t e\x1b z") + '\0' + " ä / \x7f 😀";
  const std::string text =
      text_of([&](DocumentWriter& json) { json.begin_object().member(odd, odd).end_object(); });
  EXPECT_EQ(nlohmann::json::parse(text), (nlohmann::json{{odd, odd}}));
}

TEST(JsonWriter, NumbersComeBackAsTheyWere) {
  const double denormal = std::numeric_limits<double>::denorm_min();
  for (const double number :
       {0.1, 1.0 / 3, 1e308, std::numeric_limits<double>::max(), denormal, -denormal, 1e-310, 1e22,
        123456789012345678.0, -2.5e-7, 5e-324, std::numeric_limits<double>::min()})
    EXPECT_EQ(back_and_forth(number), number);
  EXPECT_TRUE(std::signbit(back_and_forth(-0.0)));
  EXPECT_FALSE(std::signbit(back_and_forth(0.0)));

  std::mt19937_64 bits(1);
  for (int i = 0; i < 20'000; ++i) {
    const double number = std::bit_cast<double>(bits());
    if (std::isfinite(number)) {
      EXPECT_EQ(back_and_forth(number), number);
    }
  }
}

TEST(JsonWriter, NumbersAreShortAndValidJson) {
  const std::string text = text_of([](DocumentWriter& json) {
    json.begin_array()
        .value(0.1)
        .value(1e-300)
        .value(1e300)
        .value(-0.0)
        .value(std::int64_t{1} << 62)
        .end_array();
  });
  EXPECT_EQ(text, "[0.1,1e-300,1e+300,-0,4611686018427387904]");
  EXPECT_NO_THROW(nlohmann::json::parse(text));
}

TEST(JsonWriter, RefusesWhatIsNoNumber) {
  for (const double number : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    EXPECT_THROW(text_of([&](DocumentWriter& json) { json.value(number); }), std::logic_error);
}

TEST(JsonWriter, GivesBoundedPieces) {
  std::size_t pieces = 0, largest = 0, total = 0;
  const Sink sink = [&](std::string_view piece) {
    ++pieces;
    largest = std::max(largest, piece.size());
    total += piece.size();
    return true;
  };
  PieceWriter out(sink);
  JsonWriter json(out);
  json.begin_array().json('"' + std::string(500'000, 'a') + '"').value(std::string(300'000, '\n'));
  for (int i = 0; i < 100'000; ++i) json.value(i);
  json.end_array();
  out.flush();
  EXPECT_EQ(largest, PieceWriter::piece_size);
  EXPECT_EQ(total, 2 + 500'002 + 1 + 600'002 + 488'890 + 100'000u);
  EXPECT_EQ(pieces, (total + PieceWriter::piece_size - 1) / PieceWriter::piece_size);
}

TEST(JsonWriter, StopsWhenNobodyReads) {
  int pieces = 0;
  const Sink sink = [&](std::string_view) { return ++pieces < 3; };
  PieceWriter out(sink);
  JsonWriter json(out);
  const auto write_much = [&] {
    json.begin_array();
    for (int i = 0; i < 1'000'000; ++i) json.value(i);
  };
  EXPECT_THROW(write_much(), SinkClosed);
  EXPECT_EQ(pieces, 3);
}

}  // namespace
}  // namespace signorini::api::json_writer_test
