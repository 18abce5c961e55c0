#include "api/document/cbor_writer.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "written_by.hpp"

namespace signorini::api::cbor_writer_test {
namespace {

std::string hex_of(const WriteDocument& write) {
  std::string hex;
  for (const char byte : text_of(write, Format::cbor)) {
    constexpr std::string_view digits = "0123456789abcdef";
    const auto code = static_cast<unsigned char>(byte);
    hex += {digits[code / 16], digits[code % 16]};
  }
  return hex;
}

template <typename Value>
std::string hex_of_value(const Value& value) {
  return hex_of([&](DocumentWriter& out) { out.value(value); });
}

TEST(CborWriter, EncodesIntegersAsInTheExamplesOfTheRfc) {
  // RFC 8949, appendix A.
  EXPECT_EQ(hex_of_value(0), "00");
  EXPECT_EQ(hex_of_value(23), "17");
  EXPECT_EQ(hex_of_value(24), "1818");
  EXPECT_EQ(hex_of_value(100), "1864");
  EXPECT_EQ(hex_of_value(1000), "1903e8");
  EXPECT_EQ(hex_of_value(1'000'000), "1a000f4240");
  EXPECT_EQ(hex_of_value(1'000'000'000'000), "1b000000e8d4a51000");
  EXPECT_EQ(hex_of_value(-1), "20");
  EXPECT_EQ(hex_of_value(-100), "3863");
  EXPECT_EQ(hex_of_value(-1000), "3903e7");
  EXPECT_EQ(hex_of_value(std::numeric_limits<std::int64_t>::min()), "3b7fffffffffffffff");
}

TEST(CborWriter, EncodesTheOtherValuesAsInTheExamplesOfTheRfc) {
  EXPECT_EQ(hex_of_value(1.1), "fb3ff199999999999a");
  EXPECT_EQ(hex_of_value(-4.1), "fbc010666666666666");
  EXPECT_EQ(hex_of_value(false), "f4");
  EXPECT_EQ(hex_of_value(true), "f5");
  EXPECT_EQ(hex_of([](DocumentWriter& out) { out.null(); }), "f6");
  EXPECT_EQ(hex_of_value(""), "60");
  EXPECT_EQ(hex_of_value("\"\\"), "62225c");
  EXPECT_EQ(hex_of_value("\u6c34"), "63e6b0b4");
  EXPECT_EQ(hex_of([](DocumentWriter& out) {
              out.begin_object().member("Fun", true).member("Amt", -2).end_object();
            }),
            "bf6346756ef563416d7421ff");
  EXPECT_EQ(hex_of([](DocumentWriter& out) {
              out.begin_array().value(1).begin_array().value(2).value(3).end_array().end_array();
            }),
            "9f019f0203ffff");
}

TEST(CborWriter, WritesArraysOfNumbersAsTypedArrays) {
  const std::vector<double> numbers{1.1, -4.1};
  EXPECT_EQ(hex_of([&](DocumentWriter& out) { out.numbers({2}, std::span(numbers)); }),
            "d856509a9999999999f13f66666666666610c0");
  // RFC 8746, 3.1.1 is the array [[2, 4, 8], [4, 16, 256]] of another type.
  const std::vector<int> rows{2, 4, 8, 4, 16, -256};
  EXPECT_EQ(hex_of([&](DocumentWriter& out) {
              out.numbers({2, 3}, std::span<const std::int32_t>(rows));
            }),
            "d82882820203d84e581802000000040000000800000004000000100000"
            "0000ffffff");
  EXPECT_EQ(hex_of([](DocumentWriter& out) {
              out.rows({0, 3}, [](std::size_t) { return std::array<int, 3>{}; });
            }),
            "d82882820003d84e40");
}

TEST(CborWriter, TranscribesJson) {
  const nlohmann::json document = nlohmann::json::parse(
      R"({"a": [1, -2, 0.1, 1e300, 18446744073709551615], "b": {"c": null, "d": [true, false, []]}, "ä": "€"})");
  const std::string cbor = text_of([&](DocumentWriter& out) { out.json(document.dump()); }, Format::cbor);
  EXPECT_EQ(nlohmann::json::from_cbor(cbor), document);
  EXPECT_THROW(text_of([](DocumentWriter& out) { out.json("[1, 2"); }, Format::cbor), std::logic_error);
}

TEST(CborWriter, RefusesWhatIsNoNumber) {
  for (const double number : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    EXPECT_THROW(hex_of_value(number), std::logic_error);
    EXPECT_THROW(hex_of([&](DocumentWriter& out) { out.numbers({1}, std::span(&number, 1)); }),
                 std::logic_error);
  }
}

}  // namespace
}  // namespace signorini::api::cbor_writer_test
