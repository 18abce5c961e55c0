#include "api/document/cbor_document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "api/document/json_document.hpp"
#include "api/examples.hpp"
#include "written_by.hpp"

namespace signorini::api::cbor_document_test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr std::size_t plenty = 1 << 20;

json read(const std::string& bytes) {
  return parse_json(json_of_cbor(bytes, plenty).value());
}

std::string cbor_of(const json& document) {
  const std::vector<std::uint8_t> bytes = json::to_cbor(document);
  return {bytes.begin(), bytes.end()};
}

std::string bytes(std::initializer_list<int> values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

std::string refusal(const std::string& document) {
  try {
    json_of_cbor(document, plenty);
  } catch (const MalformedCbor& malformed) {
    return malformed.what();
  }
  return "taken";
}

TEST(ReadCbor, HasTheSameDocumentAsTheJson) {
  for (const Example& example : examples()) {
    const json document = json::parse(example.json);
    EXPECT_EQ(read(cbor_of(document)), document) << example.name;
    // Ours has containers of indefinite length.
    EXPECT_EQ(read(text_of([&](DocumentWriter& out) { out.json(example.json); }, Format::cbor)), document);
  }
  for (const char* text : {"null", "true", "[]", "{}", "-1", "18446744073709551615", "-9223372036854775808",
                           "1e-300", R"(["", "ä\u0000\n\"", [[], {}], {"a": {"b": [1.5]}}])"})
    EXPECT_EQ(read(cbor_of(json::parse(text))), json::parse(text)) << text;
}

TEST(ReadCbor, TakesWhatTheServiceWrites) {
  const std::vector<double> numbers{1, -2.5, 1e300, 0.1, 5, 6};
  const std::vector<std::int32_t> integers{1, -2, 100000};
  const auto document = [&](DocumentWriter& out) {
    out.begin_object();
    out.key("matrix").numbers({3, 2}, std::span(numbers));
    out.key("cube").numbers({1, 3, 2}, std::span(numbers));
    out.key("integers").numbers({3}, std::span(integers));
    out.key("none").numbers({0}, std::span<const double>());
    out.end_object();
  };
  EXPECT_EQ(read(text_of(document, Format::cbor)), json::parse(text_of(document)));
}

TEST(ReadCbor, KnowsEveryTypedArrayUpTo64Bits) {
  const auto array = [](int tag, const std::string& numbers) {
    return bytes({0xd8, tag, 0x40 + static_cast<int>(numbers.size())}) + numbers;
  };
  EXPECT_EQ(read(array(64, bytes({1, 255}))), json({1, 255}));
  EXPECT_EQ(read(array(68, bytes({1, 255}))), json({1, 255}));
  EXPECT_EQ(read(array(65, bytes({1, 2}))), json({258}));
  EXPECT_EQ(read(array(69, bytes({1, 2}))), json({513}));
  EXPECT_EQ(read(array(66, bytes({0xff, 0, 0, 1}))), json({4278190081}));
  EXPECT_EQ(read(array(70, bytes({1, 0, 0, 0xff}))), json({4278190081}));
  EXPECT_EQ(read(array(67, bytes({0, 0, 0, 0, 0, 0, 0, 2}))), json({2}));
  EXPECT_EQ(read(array(71, bytes({2, 0, 0, 0, 0, 0, 0, 0}))), json({2}));
  EXPECT_EQ(read(array(72, bytes({0xff, 1}))), json({-1, 1}));
  EXPECT_EQ(read(array(73, bytes({0xff, 0xfe}))), json({-2}));
  EXPECT_EQ(read(array(77, bytes({0xfe, 0xff}))), json({-2}));
  EXPECT_EQ(read(array(74, bytes({0xff, 0xff, 0xff, 0xfe}))), json({-2}));
  EXPECT_EQ(read(array(78, bytes({0xfe, 0xff, 0xff, 0xff}))), json({-2}));
  EXPECT_EQ(read(array(79, bytes({0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}))), json({-2}));
  EXPECT_EQ(read(array(75, bytes({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe}))), json({-2}));
  EXPECT_EQ(read(array(80, bytes({0x3e, 0}))), json({1.5}));
  EXPECT_EQ(read(array(84, bytes({0, 0x3e}))), json({1.5}));
  EXPECT_EQ(read(array(81, bytes({0x3f, 0xc0, 0, 0}))), json({1.5}));
  EXPECT_EQ(read(array(85, bytes({0, 0, 0xc0, 0x3f}))), json({1.5}));
  EXPECT_EQ(read(array(82, bytes({0x3f, 0xf8, 0, 0, 0, 0, 0, 0}))), json({1.5}));
  EXPECT_EQ(read(array(86, bytes({0, 0, 0, 0, 0, 0, 0xf8, 0x3f}))), json({1.5}));
  EXPECT_EQ(read(bytes({0xd9, 0xd9, 0xf7, 0x81, 7})), json({7}));  // it says itself that it is CBOR
  EXPECT_EQ(read(bytes({0xf9, 0x3e, 0})), json(1.5));
}

TEST(ReadCbor, RefusesWhatHasNoJsonAndNamesTheByte) {
  const std::vector<std::pair<std::string, std::string>> refused{
      {"", "too early (byte 0)"},
      {bytes({0x82, 1}), "too early (byte 2)"},
      {bytes({0x81, 1, 2}), "more bytes follow"},
      {bytes({0x9f, 1}), "too early (byte 2)"},
      {bytes({0x81, 0x1c}), "begins no item (byte 1)"},
      {bytes({0xff}), "a break"},
      {bytes({0x82, 1, 0xff}), "a break"},
      {bytes({0xa1, 1, 2}), "key"},
      {bytes({0xbf, 0x61, 'a', 0xff}), "a break"},
      {bytes({0xf7}), "undefined"},
      {bytes({0x7f, 0x61, 'a', 0xff}), "indefinite length"},
      {bytes({0x41, 1}), "typed arrays"},
      {bytes({0xf9, 0x7c, 0}), "not finite"},
      {bytes({0xc0, 0x61, 'a'}), "tag 0 has no meaning"},
      {bytes({0xd8, 76, 0x41, 1}), "tag 76"},
      {bytes({0xd8, 83, 0x50}) + std::string(16, 0), "tag 83"},
      {bytes({0xd8, 86, 0x44, 0, 0, 0, 0}), "8 a number"},
      {bytes({0xd8, 86, 1}), "8 a number"},
      {bytes({0xd8, 84, 0x42, 0, 0x7c}), "number 0 of a typed array is not finite"},
      {bytes({0xd8, 40, 1}), "array of two"},
      {bytes({0xd8, 40, 0x82, 0x82, 2, 2, 0x84, 1, 2, 3, 4}), "typed array"},
      {bytes({0xd8, 40, 0x82, 0x82, 2, 2, 0xd8, 64, 0x43, 1, 2, 3}), "the 3 numbers"},
      {bytes({0xd8, 40, 0x82, 0x82, 0, 2, 0xd8, 64, 0x43, 1, 2, 3}), "extent"},
      {bytes({0xd8, 40, 0x82, 0x80, 0xd8, 64, 0x41, 1}), "extents"},
      {bytes({0x9b, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff}), "too early"},
      {std::string(100'000, '\x81'), "deeper than 64"},
  };
  for (const auto& [document, why] : refused) EXPECT_THAT(refusal(document), HasSubstr(why));
}

/// However it is cut or changed, it is read or refused.
TEST(ReadCbor, SurvivesDamage) {
  const std::string document = cbor_of(json::parse(examples().front().json));
  for (std::size_t i = 0; i < document.size(); ++i) {
    EXPECT_NE(refusal(document.substr(0, i)), "taken");
    for (const int change : {1, 0x20, 0x80}) {
      std::string damaged = document;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      refusal(damaged);
    }
  }
}

TEST(ReadCbor, IsNoLongerThanItMayBe) {
  const json document(1000, 12345);
  EXPECT_EQ(json_of_cbor(cbor_of(document), 6001)->size(), 6001u);
  EXPECT_FALSE(json_of_cbor(cbor_of(document), 6000));
}

}  // namespace
}  // namespace signorini::api::cbor_document_test
