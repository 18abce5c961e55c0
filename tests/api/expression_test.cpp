#include "api/problem/expression.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <muParser.h>

#include "faults_of.hpp"

namespace signorini::api::expression_test {
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

/// Random expressions of all that there is, as another parser reads them.
class RandomText {
 public:
  explicit RandomText(unsigned seed) : engine_(seed) {}

  std::string operator()(int depth) {
    if (depth == 0) return leaf();
    switch (choose(5)) {
      case 0:
        return function(depth);
      case 1:
        return "(" + (*this)(depth - 1) + blank() + "?" + (*this)(depth - 1) + ":" + (*this)(depth - 1) + ")";
      case 2:
        return sign() + "(" + (*this)(depth - 1) + ")";
      default: {
        // Without parentheses: what binds more strongly must be known.
        static const char* const signs[] = {
            "+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "&&", "||"};
        return operand(depth) + blank() + signs[choose(13)] + blank() + operand(depth) + signs[choose(5)] +
               leaf();
      }
    }
  }

 private:
  int choose(int n) { return std::uniform_int_distribution<>(0, n - 1)(engine_); }
  std::string blank() { return choose(3) ? "" : " "; }
  std::string sign() { return choose(2) ? "-" : ""; }
  std::string operand(int depth) { return choose(2) ? leaf() : (*this)(depth - 1); }
  std::string leaf() {
    static const char* const leaves[] = {"x", "y", "2", "0.5", "1e-1", "3.", ".25", "pi", "1.5E+0"};
    return leaves[choose(9)];
  }
  std::string function(int depth) {
    const std::vector<std::string_view>& names = function_names();
    const std::string name(names[choose(static_cast<int>(names.size()))]);
    int arguments = name == "atan2" ? 2 : 1;
    if (name == "min" || name == "max" || name == "sum" || name == "avg") arguments = 1 + choose(3);
    std::string text = name + "(";
    for (int i = 0; i < arguments; ++i) text += (i ? "," : "") + (*this)(depth - 1);
    return text + ")";
  }

  std::mt19937 engine_;
};

TEST(Expression, IsReadAsMuParserReadsIt) {
  mu::Parser parser;
  // Which folds 0.5 && 0.5 to 0.
  parser.EnableOptimizer(false);
  double x = 0.37, y = -1.21;
  parser.DefineVar("x", &x);
  parser.DefineVar("y", &y);
  parser.DefineConst("pi", pi);
  RandomText random(5);
  int finite = 0;
  for (int i = 0; i < 4000; ++i) {
    const std::string text = random(3);
    if (text.size() > 1000) continue;
    parser.SetExpr(text);
    double theirs = 0;
    std::string their_fault;
    try {
      theirs = parser.Eval();
    } catch (const mu::ParserError& error) {
      their_fault = error.GetMsg();
    }
    try {
      const double ours = parse_formula(text, false)(x, y);
      ASSERT_EQ(their_fault, "") << text;
      if (std::isnan(theirs)) {
        ASSERT_TRUE(std::isnan(ours)) << text;
        continue;
      }
      ++finite;
      if (std::isinf(theirs) || theirs == 0)
        ASSERT_EQ(ours, theirs) << text;
      else
        ASSERT_NEAR(ours / theirs, 1, 1e-10) << text;
    } catch (const std::invalid_argument& fault) {
      ASSERT_NE(their_fault, "") << text << ": " << fault.what();
    }
  }
  EXPECT_GT(finite, 1000);
}

}  // namespace
}  // namespace signorini::api::expression_test
