#include "api/expression.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "faults_of.hpp"

namespace signorini::api {
namespace {

using testing::HasSubstr;

constexpr double pi = std::numbers::pi;

double at(double x, double y, const std::string& text) {
  return compile_expression(text, "/f", Variables::interior)(Point(x, y));
}

std::string refusal(const std::string& text, Variables variables = Variables::interior) {
  const auto faults = faults_of([&] { compile_expression(text, "/load/body", variables); });
  if (faults.empty()) return "accepted";
  EXPECT_EQ(pointers_of(faults), std::vector<std::string>{"/load/body"});
  return faults.front().detail;
}

TEST(Expression, EvaluatesWhatItSays) {
  EXPECT_EQ(at(0.25, 3, "x + y"), 3.25);
  EXPECT_EQ(at(0.25, 3, "2*x*y - 1"), 0.5);
  EXPECT_EQ(at(0.25, 0, "x < 0.5 ? 10 : -10"), 10);
  EXPECT_EQ(at(0.75, 0, "x < 0.5 ? 10 : -10"), -10);
  EXPECT_EQ(at(0.6, 0, "x < 0.5 ? 1 : x < 0.7 ? 2 : 3"), 2);
  EXPECT_EQ(at(0.5, 0.5, "x >= 0.5 && y != 1 || 0"), 1);
  EXPECT_EQ(at(3, 0, "-x^2"), -9);
  EXPECT_EQ(at(2, 3, "x^y^2"), 512);
  EXPECT_EQ(at(1e-3, 0, "1e-3 == x"), 1);
  EXPECT_EQ(at(-1, 0, "atan2(y, x)"), pi);
  EXPECT_EQ(at(0, 0, "cos(x) + exp(y)"), 2);
  EXPECT_EQ(at(4, 0, "sqrt (x)"), 2) << "blanks between a function and its argument";
  EXPECT_EQ(at(4, 9, "max(x, y)\n +\tmin(x, y)"), 13);
  EXPECT_DOUBLE_EQ(at(std::numbers::e, 0, "log(x)"), 1);
}

TEST(Expression, KnowsPiToTheLastDigit) {
  EXPECT_EQ(at(1, 0, "x * pi"), pi);
}

TEST(Expression, HasTheNormalOnTheBoundaryOnly) {
  const Field field = compile_expression("nx + 10 * ny + x", "/f", Variables::boundary);
  EXPECT_EQ(field(Point(0.5, 0), Vector(0, -1)), -9.5);
  EXPECT_THAT(refusal("nx"), HasSubstr("variables: x, y;"));
}

TEST(Expression, WithoutVariablesIsAConstant) {
  const Field field = compile_expression("2 * sin(pi / 2)", "/f", Variables::interior);
  EXPECT_TRUE(field.is_constant());
  EXPECT_EQ(field(Point(7, 7)), 2);
  EXPECT_EQ(field.name(), "/f");
  EXPECT_FALSE(compile_expression("0 * x", "/f", Variables::interior).is_constant());
  EXPECT_TRUE(compile_expression("exp(1) + 1e2", "/f", Variables::interior).is_constant());
}

TEST(Expression, ThatIsNotFiniteIsRefusedWithThePlace) {
  EXPECT_THAT(refusal("1/0"), HasSubstr("not finite"));
  EXPECT_THAT(refusal("sqrt(-1)"), HasSubstr("not finite"));
  const Field field = compile_expression("1 / x", "/boundary/top/gap", Variables::boundary);
  EXPECT_EQ(field(Point(2, 0)), 0.5);
  const auto faults = faults_of([&] { field(Point(0, 0.5)); });
  ASSERT_EQ(pointers_of(faults), std::vector<std::string>{"/boundary/top/gap"});
  EXPECT_THAT(faults.front().detail, HasSubstr("(0, 0.5)"));
}

TEST(Expression, RefusesUnknownNamesAndSaysWhichItKnows) {
  EXPECT_THAT(refusal("x + z"), HasSubstr("\"z\" is not known"));
  EXPECT_THAT(refusal("x + z"), HasSubstr("variables: x, y;"));
  EXPECT_THAT(refusal("z", Variables::boundary), HasSubstr("variables: x, y, nx, ny;"));
  EXPECT_THAT(refusal("sqr(x)"), HasSubstr("did you mean \"sqrt\"?"));
  for (const char* text : {"X", "_pi", "e", "rnd()", "x_1", "inf", "nan", "i"})
    EXPECT_THAT(refusal(text), HasSubstr("is not known"));
}

TEST(Expression, RefusesAssignment) {
  for (const char* text : {"x = 1", "x=y", "x == y = 1", "x <== 1", "y + (x = 2)"})
    EXPECT_THAT(refusal(text), HasSubstr("compare with ==")) << text;
  for (const char* text : {"x == 1", "x <= 1", "x >= 1", "x != 1"})
    EXPECT_EQ(refusal(text), "accepted") << text;
}

TEST(Expression, RefusesSeveralExpressions) {
  EXPECT_THAT(refusal("1, 2"), HasSubstr("several"));
  EXPECT_THAT(refusal("x ? y : 1, 2"), HasSubstr("several"));
  EXPECT_NE(refusal("(x, y)"), "accepted");
}

TEST(Expression, CapsLengthAndDepth) {
  const auto parentheses = [](std::size_t n) { return std::string(n, '(') + "x" + std::string(n, ')'); };
  EXPECT_EQ(refusal(parentheses(64)), "accepted");
  EXPECT_THAT(refusal(parentheses(65)), HasSubstr("64 levels"));
  EXPECT_EQ(refusal("x+" + std::string("0") + std::string(997, ' ')), "accepted");
  EXPECT_THAT(refusal("x+" + std::string("0") + std::string(998, ' ')), HasSubstr("the most is 1000"));
}

TEST(Expression, RefusesCharactersOfOtherLanguages) {
  for (const char* text :
       {"\"x\"", "x; y", "x[0]", "{x}", "x % 2", "x ~ y", "$x", "x\\y", "'x'", "2\xC2\xB7x", "x # y"})
    EXPECT_THAT(refusal(text), HasSubstr("may not stand in an expression")) << text;
}

TEST(Expression, RefusesWhatDoesNotParse) {
  for (const char* text :
       {"x +",      "(x",        "x)",    "()",    "2x",    "x y",   "x < 0 ? 1", "sin",
        "atan2(x)", "sin(x, y)", "min()", "x & y", "x | y", "1.2.3", "1e999",     "x ? : 1",
        ":",        "?",         ",",     "x(1)",  "2 (x)", ".",     "1e+"})
    EXPECT_NE(refusal(text), "accepted") << text;
  EXPECT_THAT(refusal("  "), HasSubstr("empty"));
}

TEST(Expression, CopiesOfAFieldAreGoodWithoutTheFirst) {
  Field copy;
  {
    const Field field = compile_expression("x * y", "/f", Variables::interior);
    copy = field;
  }
  EXPECT_EQ(copy(Point(3, 4)), 12);
}

}  // namespace
}  // namespace signorini::api
