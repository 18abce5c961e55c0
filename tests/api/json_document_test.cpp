#include "api/document/json_document.hpp"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace signorini::api::json_document_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string refusal(std::string_view text) {
  try {
    parse_json(text);
  } catch (const MalformedJson& malformed) {
    return malformed.what();
  }
  return "accepted";
}

std::string nested(std::size_t levels) {
  return std::string(levels, '[') + std::string(levels, ']');
}

TEST(ParseJson, BuildsTheDocument) {
  const auto document =
      parse_json(R"( {"a": [1, -2, 3.5, {"b": null}, []], "c": {"a": true}, "d": "\u00e4\n"} )");
  EXPECT_EQ(document,
            nlohmann::json::parse(R"({"a": [1, -2, 3.5, {"b": null}, []], "c": {"a": true}, "d": "ä\n"})"));
}

TEST(ParseJson, ReadsNumbersToTheLastDigit) {
  const auto numbers = parse_json("[5e-324, 1.7976931348623157e308, 0.1, 9007199254740993, 1e-400]");
  EXPECT_EQ(numbers[0].get<double>(), std::numeric_limits<double>::denorm_min());
  EXPECT_EQ(numbers[1].get<double>(), std::numeric_limits<double>::max());
  EXPECT_EQ(numbers[2].get<double>(), 0.1);
  EXPECT_EQ(numbers[3].get<std::int64_t>(), 9007199254740993);
  EXPECT_EQ(numbers[4].get<double>(), 0);
}

TEST(ParseJson, NamesLineAndColumn) {
  EXPECT_THAT(refusal("{\n  \"a\": 1,\n  \"b\": nul\n}"), HasSubstr("line 3, column"));
  EXPECT_THAT(refusal("[1 2]"), HasSubstr("line 1, column 4"));
  EXPECT_THAT(refusal("[1,\n\n1e999]"), HasSubstr("line 3"));
}

TEST(ParseJson, SaysWhatIsWrong) {
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal("\xEF\xBB\xBF{}"), HasSubstr("byte order mark"));
  EXPECT_THAT(refusal("{} {}"), HasSubstr("expected end of input"));
  EXPECT_THAT(refusal("[1e999]"), HasSubstr("too large"));
  EXPECT_THAT(refusal(std::string_view("{}\0", 3)), HasSubstr("zero byte"));
}

TEST(ParseJson, NamesThePointerOfADuplicateMember) {
  EXPECT_THAT(refusal(R"({"a": {"b/c": [0, {"d": 1, "d": 2}]}})"), HasSubstr("\"/a/b~1c/1/d\""));
  EXPECT_THAT(refusal(R"({"a": 1, "\u0061": 2})"), HasSubstr("\"/a\""));
  EXPECT_EQ(refusal(R"({"a": {"b": 1}, "b": {"a": 1}})"), "accepted");
}

TEST(ParseJson, RefusesWhatIsNoUtf8InWordsThatAre) {
  for (const std::string bytes : {"\xff", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe4"}) {
    for (const std::string& text : {"\"" + bytes + "\"", "{\"" + bytes + "\": 1}", bytes}) {
      const std::string said = refusal(text);
      EXPECT_NE(said, "accepted");
      EXPECT_NO_THROW(nlohmann::json(said).dump());
    }
  }
  EXPECT_EQ(refusal("\"\xf0\x9f\x98\x80\""), "accepted");
}

TEST(ParseJson, RefusesNumbersOfCountlessDigits) {
  const std::string digits(1000, '1'), more = digits + "1";
  for (const std::string& number : {"0." + digits, "-0." + digits + "e-5", "1e-0" + digits.substr(1)})
    EXPECT_EQ(refusal("[7, " + number + "]"), "accepted") << number;
  for (const std::string& number : {more, "-" + more, "0." + more, "1e" + more, std::string(1'000'000, '0')})
    EXPECT_THAT(refusal("[\n7, " + number + "]"), HasSubstr("more than 1000 digits in a row (line 2"))
        << number;
}

TEST(ParseJson, TakesCountlessDigitsInStrings) {
  const std::string digits(5000, '1');
  EXPECT_EQ(refusal(R"({"a": ")" + digits + R"(", "b": "\"\\)" + digits + R"("})"), "accepted");
  EXPECT_THAT(refusal(R"({"a": ")" + digits + R"(\\", "b": )" + digits + "}"), HasSubstr("1000 digits"));
}

TEST(ParseJson, StopsAtTheDepthLimitWithoutRecursion) {
  EXPECT_EQ(refusal(nested(64)), "accepted");
  EXPECT_THAT(refusal(nested(65)), HasSubstr("64 levels"));
  EXPECT_THAT(refusal(std::string(1'000'000, '[')), HasSubstr("64 levels"));
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
  EXPECT_THAT(refusal(objects), HasSubstr("64 levels"));
}

TEST(ParseJson, CountsDepthNotContainers) {
  std::string many = "[";
  for (int i = 0; i < 60'000; ++i) many += "[{}],";
  EXPECT_EQ(parse_json(many + "0]").size(), 60'001u);
}

std::string repeated(const std::string& element, int times) {
  std::string list = "[";
  for (int i = 0; i < times; ++i) list += element + ",";
  return list + element + "]";
}

/// What takes many times its text in memory is no problem; a mesh takes some seven times as much.
TEST(ParseJson, CountsWhatTheValuesTake) {
  EXPECT_THAT(refusal(R"({"quantities": )" + repeated("{}", 150'000) + "}"), HasSubstr("MB"));
  EXPECT_THAT(refusal(repeated("{\"a\":{}}", 90'000)), HasSubstr("MB"));
  EXPECT_EQ(refusal(R"({"domain": {"points": )" + repeated("[0,0]", 80'000) + "}}"), "accepted");
  EXPECT_EQ(refusal(R"({"domain": {"points": )" + repeated("[0.12345,0.6789]", 250'000) +
                    R"(, "triangles": )" + repeated("[12345,12346,12400]", 250'000) + "}}"),
            "accepted");
}

/// Of its domain a polygon has thousands of values only.
TEST(ParseJson, CountsWhatIsNotInAMesh) {
  EXPECT_THAT(refusal(R"({"domain": {"sides": )" + repeated("\"\"", 1'500'000) + "}}"),
              HasSubstr("300000 values"));
  EXPECT_THAT(refusal(R"({"domain": {"vertices": )" + repeated("[0.123456,0.345678]", 600'000) + "}}"),
              HasSubstr("300000 values"));
}

TEST(ParseJson, DoesNotRepeatALongTextThatItRefuses) {
  EXPECT_LT(refusal("[\"" + std::string(1'000'000, 'a')).size(), 300u);
  EXPECT_LT(refusal("{\"" + std::string(1000, 'k') + "\": 1, \"" + std::string(1000, 'k') + "\": 1}").size(),
            300u);
}

}  // namespace
}  // namespace signorini::api::json_document_test
