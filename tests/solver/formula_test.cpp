#include "formula/formula.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fem/triangle_pieces.hpp"
#include "formula/enclosure.hpp"
#include "formula/rounding.hpp"
#include "formula/series.hpp"
#include "formula/taylor_model.hpp"
#include "problem/field.hpp"

namespace signorini::formula_test {
namespace {

/// All operations, with smooth, steep, kinked and jumping functions, and some with poles or branch points
/// near by.
const char* const kFormulas[] = {
    "x*y+1",
    "sin(3*x)*cos(2*y)",
    "exp(-((x-0.37)^2+(y-0.61)^2)/0.01)",
    "sqrt(1+x^2+y)",
    "(x^2+y^2)^0.75",
    "tan(x*y)",
    "atan2(y-0.4,x-0.5)",
    "atan2(y+0.1,-x-0.2)",
    "x<0.3?10:-10",
    "x<=y && x*y>0.1 || x==0.5 ? 1 : x!=y",
    "abs(x-y)",
    "tanh(20*(x-0.4142))",
    "log(2+x)/(1+y*y)",
    "asin(x/3)+acos(y/3)+sinh(x)+cosh(y)",
    "x^y+2^x+(-1-x)^3+(1+x)^-2",
    "max(x,y,0.2)-min(x,y)+sum(x,1,y)*avg(x,y,1)",
    "rint(3*x)+sign(y-0.3)",
    "acosh(2+x)+asinh(y)+atanh(x/3)+log2(1+x)+log10(1+y)+ln(3-x)+atan(5*y)",
    "sign(x^2+y^2-0.25)",
    "1/(1+25*x^2)",
    "sin(x-0.3)/(x-0.3)",
    "log(x-0.2)",
    "sin(97*x)",
    "(x-y)^9+(x-0.5)^40",
};

class RandomTriangles {
 public:
  double number(double low, double high) { return std::uniform_real_distribution<>(low, high)(engine_); }

  std::array<Point, 3> triangle() {
    const double size = number(0.01, 0.4);
    const Point at(number(0, 1), number(0, 1));
    std::array<Point, 3> corners;
    for (Point& corner : corners) corner = at + size * Vector(number(-1, 1), number(-1, 1));
    return corners;
  }

  Point inside() {
    const double a = number(0, 1), b = number(0, 1);
    return a + b > 1 ? Point(1 - a, 1 - b) : Point(a, b);
  }

 private:
  std::mt19937 engine_{7};
};

Enclosure<TaylorModel> on_triangle(const std::array<Point, 3>& corners) {
  const auto& [a, b, c] = corners;
  return {TaylorModel::linear({a.x(), b.x(), c.x()}), TaylorModel::linear({a.y(), b.y(), c.y()}),
          TaylorModel(0.), TaylorModel(0.)};
}

TEST(Formula, IsEnclosedOnTriangles) {
  RandomTriangles random;
  for (const char* text : kFormulas) {
    const Formula formula = parse_formula(text, false);
    int known = 0;
    for (int i = 0; i < 300; ++i) {
      const std::array<Point, 3> corners = random.triangle();
      Enclosure<TaylorModel> enclosure = on_triangle(corners);
      const TaylorModel model = formula.evaluate(enclosure);
      known += std::isfinite(model.remainder());
      for (int k = 0; k < 60; ++k) {
        const Point own = random.inside();
        const Point at =
            corners[0] + own.x() * (corners[1] - corners[0]) + own.y() * (corners[2] - corners[0]);
        const double value = formula(at.x(), at.y());
        // A formula that is not finite has no enclosure.
        if (!std::isfinite(value)) {
          ASSERT_FALSE(is_known(model.values())) << text;
          continue;
        }
        const double rounding = 1e-12 * (1 + std::abs(value));
        ASSERT_LE(std::abs(value - model.at(own.x(), own.y())), model.remainder() + rounding) << text;
        ASSERT_GE(value, model.values().lower() - rounding) << text;
        ASSERT_LE(value, model.values().upper() + rounding) << text;
      }
    }
    EXPECT_GT(known, 30) << text << " is hardly ever enclosed";
  }
}

/// By the Taylor polynomial about the middle with the last coefficient taken from the whole interval.
TEST(Formula, IsEnclosedWithItsDerivativesOnLines) {
  RandomTriangles random;
  constexpr int order = 7;
  for (const char* text : kFormulas) {
    const Formula formula = parse_formula(text, false);
    for (int i = 0; i < 300; ++i) {
      const auto [a, b, c] = random.triangle();
      const Vector way = b - a;
      const auto on = [&, a = a](const Interval& s) -> Enclosure<Series> {
        return {Series::line(order, a.x() + way.x() * s, way.x()),
                Series::line(order, a.y() + way.y() * s, way.y()), Series(order, 0), Series(order, 0)};
      };
      Enclosure<Series> everywhere = on(Interval(0, 1)), in_middle = on(0.5);
      const Series all = formula.evaluate(everywhere), middle = formula.evaluate(in_middle);
      for (int k = 0; k < 40; ++k) {
        const double s = random.number(0, 1);
        const Point at = a + s * way;
        const double value = formula(at.x(), at.y());
        if (!std::isfinite(value)) continue;
        const double rounding = 1e-12 * (1 + std::abs(value));
        Interval polynomial = 0;
        double power = 1;
        for (int j = 0; j < order; ++j, power *= s - 0.5) polynomial += middle[j] * power;
        polynomial += all[order] * power;
        if (is_known(all[order])) {
          ASSERT_GE(value, polynomial.lower() - rounding) << text;
          ASSERT_LE(value, polynomial.upper() + rounding) << text;
        }
        ASSERT_GE(value, all[0].lower() - rounding) << text;
        ASSERT_LE(value, all[0].upper() + rounding) << text;
      }
    }
  }
}

TEST(Formula, OfAPolynomialIsKnownExactly) {
  const std::array<Point, 3> corners{Point(0.1, 0.2), Point(0.9, 0.3), Point(0.4, 0.8)};
  Enclosure<TaylorModel> enclosure = on_triangle(corners);
  const TaylorModel model = parse_formula("(1 + x - 2*y)^2 * (3 - x*y) / 4", false).evaluate(enclosure);
  EXPECT_EQ(model.remainder(), 0);
  EXPECT_EQ(model.degree(), 4);
}

/// No polynomial that leaves out more than the power itself is of use.
TEST(Formula, OfAHighPowerIsSmallBesideItsZero) {
  constexpr double length = 0.125;
  for (const int exponent : {9, 10, 20, 41}) {
    Enclosure<TaylorModel> enclosure = on_triangle({Point(0, 0), Point(length, 0), Point(0, length)});
    const TaylorModel model = parse_formula("y^" + std::to_string(exponent), false).evaluate(enclosure);
    EXPECT_LE(model.remainder(), std::pow(length, exponent)) << exponent;
  }
}

/// Also in the single point where it vanishes: 0^0 = 1.
TEST(Formula, OfAWholePowerHasAllDerivativesAtItsZero) {
  for (const int exponent : {0, 1, 2, 3, 12}) {
    const Formula formula = parse_formula("sin(x)^" + std::to_string(exponent), false);
    Enclosure<Series> at_zero{Series::line(9, 0, 1), Series(9, 0), Series(9, 0), Series(9, 0)};
    const Series series = formula.evaluate(at_zero);
    for (int k = 0; k <= std::min(exponent, 9); ++k) {
      EXPECT_NEAR(series[k].lower(), k == exponent, 1e-15) << exponent;
      EXPECT_NEAR(series[k].upper(), k == exponent, 1e-15) << exponent;
    }
    for (int k = 0; k <= 9; ++k) EXPECT_TRUE(is_known(series[k])) << exponent;
  }
}

/// Against the same number, written without cancellation.
TEST(Formula, KnowsWhatRoundingTakesFromItsValues) {
  const std::pair<const char*, const char*> pairs[] = {{"(1-cos(1e-8*x))*2e16", "x^2"},
                                                       {"(1e6+x)^2-1e12-2e6*x", "x^2"},
                                                       {"(x+1e16)-1e16", "x"},
                                                       {"sqrt(1e14+2e7*x+x*x)-1e7", "x"},
                                                       {"log(exp(1e-9*x))*1e9", "x"},
                                                       {"cosh(9*x)^2-sinh(9*x)^2", "1"},
                                                       {"(exp(1e-7*x)-1)*1e7", "x+0.5e-7*x*x"},
                                                       {"(x<2 ? x+1e9 : 0)-1e9", "x"},
                                                       {"tan(atan(1e7+x))-1e7", "x"},
                                                       {"min(x+1e12,2e12)-1e12", "x"}};
  for (const auto& [text, plain] : pairs) {
    const Formula formula = parse_formula(text, false), same = parse_formula(plain, false);
    double most = 0;
    for (const double x : {0.1, 0.37, 0.7132, 0.99}) {
      const double error = std::abs(formula(x, 0) - same(x, 0)), rounding = rounding_of(formula, x, 0);
      EXPECT_LE(error, 1.1 * rounding) << text << " at " << x;
      most = std::max(most, error / rounding);
    }
    EXPECT_GE(most, 1e-3) << text;
  }
  for (const char* text : {"x^2*y", "sin(3*x)+2", "x<0.3 ? 10 : -10", "exp(-9*x)*sqrt(x+y)", "abs(x-y)+1"}) {
    const Formula formula = parse_formula(text, false);
    EXPECT_LE(rounding_of(formula, 0.6, 0.1), 1e-14 * std::abs(formula(0.6, 0.1))) << text;
  }
}

TEST(Formula, TellsWhatItCannotRead) {
  for (const char* text :
       {"", "1 +", "(x", "x)", "--3", "2x", "sin x", "sin()", "sin(x, y)", "x ? 1", "nx", "1e400"})
    EXPECT_THROW(parse_formula(text, false), std::invalid_argument) << text;
  EXPECT_NO_THROW(parse_formula("nx - -ny", true));
}

/// The pieces fill the triangle, and what they say of the integral is true.
struct Integral {
  double area = 0, value = 0, uncertain = 0;
  int pieces = 0;

  Integral(const char* text, const std::array<Point, 3>& corners, double tolerance) {
    const Field field(parse_formula(text, false), "/f");
    const Field* fields[] = {&field};
    CellBudget budget{100'000};
    for_each_piece(fields, corners, mean_remainder_below(tolerance), budget, [&](const TrianglePiece& piece) {
      ++pieces;
      area += piece.share;
      uncertain += piece.share * piece.models[0].remainder();
      // The corners and the middles of the sides; exact for the formulas below.
      for (const Point& x : {Point(0.5, 0), Point(0, 0.5), Point(0.5, 0.5)})
        value += piece.share * piece.models[0].at(x.x(), x.y()) / 3;
    });
  }
};

TEST(TrianglePieces, OfAStraightJumpLeaveNothingOver) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  const Integral jump("x < 0.3 ? 10 : -10", corners, 1e-9);
  EXPECT_NEAR(jump.area, 1, 1e-14);
  EXPECT_EQ(jump.uncertain, 0);
  EXPECT_NEAR(jump.value, 10 - 20 * 0.49, 1e-13);
  EXPECT_LE(jump.pieces, 4);
  const Integral kink("abs(x - y) + max(x, 0.25)", corners, 1e-9);
  EXPECT_EQ(kink.uncertain, 0);
  // Means over the triangle: of |x − y| 1/3; of max(x, c) c + (1 − c)³ / 3.
  EXPECT_NEAR(kink.value, 1. / 3 + 0.25 + std::pow(0.75, 3) / 3, 1e-13);
}

TEST(TrianglePieces, OfACurveKnowWhatIsLeft) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  // A quarter of the disc lies in the triangle, whose area is 1/2.
  const double mean = 1 + 2 * 2 * std::numbers::pi / 16;
  for (const double tolerance : {1e-2, 1e-4, 1e-6}) {
    const Integral disc("x^2 + y^2 < 0.25 ? 3 : 1", corners, tolerance);
    EXPECT_NEAR(disc.area, 1, 1e-12);
    EXPECT_LE(disc.uncertain, 5 * tolerance);
    EXPECT_LE(std::abs(disc.value - mean), disc.uncertain + 1e-12);
  }
}

TEST(TrianglePieces, EndWhereNothingIsKnown) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  EXPECT_FALSE(std::isfinite(Integral("sin(x - 0.3)/(x - 0.3)", corners, 1e-6).uncertain));
}

}  // namespace
}  // namespace signorini::formula_test
