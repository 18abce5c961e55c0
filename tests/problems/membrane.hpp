#pragma once

#include <cmath>
#include <random>
#include <sstream>

#include "solve.hpp"

/// Membrane problems with known answers, shared by the tests.
namespace signorini::problems {

/// What is known in single points only, so that nothing is guaranteed.
inline Field function(std::function<double(const Point&)> f, const std::string& name = "/test") {
  return Field([f = std::move(f)](const Point& x, const Vector&) { return f(x); }, name);
}

/// A formula of x, y, nx and ny.
inline Field formula(const std::string& text, const std::string& name = "/test") {
  return Field(parse_formula(text, true), name);
}

/// All digits of a number, as it may stand in a formula.
inline std::string digits(double value) {
  std::ostringstream text;
  text.precision(17);
  text << '(' << value << ')';
  return text.str();
}

/// mean + size sin(a x + b y + phase).
inline Field wave(double mean, double size, double a, double b, double phase) {
  return formula(digits(mean) + "+" + digits(size) + "*sin(" + digits(a) + "*x+" + digits(b) + "*y+" +
                 digits(phase) + ")");
}

/// Section 6 of the paper on n × n squares.
inline Problem paper(Scheme scheme, int n) {
  Problem problem;
  problem.mesh.fineness = Divisions{n, n};
  problem.scheme = scheme;
  problem.body = formula("x < 0.5 ? 10 : -10");
  problem.boundary = {{"left", Fixed{}}, {"right", Fixed{}}, {"bottom", Contact{}}, {"top", Contact{}}};
  return problem;
}

/// Exact to nine digits, by a boundary integral equation.
struct PaperValues {
  static constexpr double contact_begin = 0.603652770;
  static constexpr double force_on_one_side = 0.493948767;
  static constexpr double energy = -0.914792951;
  static constexpr double displacement_left = 0.358355538;    ///< u(1/4, 1/2)
  static constexpr double displacement_right = -0.244906216;  ///< u(3/4, 1/2)
  static constexpr double displacement_norm = 0.219135716;
};

/// u = Re (x + iy)^{3/2} on (−1, 1) × (0, 1): open for x > 0, closed for x < 0 with pressure (3/2)|x|^{1/2}.
struct SignoriniEdge {
  static double u(const Point& x) {
    return std::pow(x.norm(), 1.5) * std::cos(1.5 * std::atan2(x.y(), x.x()));
  }

  static Vector stress(const Point& x) {
    const double root = std::sqrt(x.norm()), half = 0.5 * std::atan2(x.y(), x.x());
    return 1.5 * root * Vector(std::cos(half), -std::sin(half));
  }

  static Problem problem(Scheme scheme, int n) {
    Problem problem;
    problem.domain = Rectangle{{-1, 0}, {2, 1}};
    problem.mesh.fineness = Divisions{2 * n, n};
    problem.scheme = scheme;
    const Fixed exact{formula("(x^2 + y^2)^0.75 * cos(1.5 * atan2(y, x))")};
    problem.boundary = {{"left", exact}, {"right", exact}, {"top", exact}, {"bottom", Contact{}}};
    return problem;
  }
};

/// A random rectangle, mesh, stiffness, load and gap; at least one fixed and one contact part.
inline Problem random(unsigned seed) {
  std::mt19937 engine(seed);
  const auto number = [&](double low, double high) {
    return std::uniform_real_distribution<>(low, high)(engine);
  };
  const auto choose = [&](int n) { return std::uniform_int_distribution<>(0, n - 1)(engine); };
  const auto wave = [&](double mean, double size) {
    const double a = number(2, 6), b = number(-3, 3), phase = number(0, 6);
    return problems::wave(mean, size, a, b, phase);
  };
  Problem problem;
  problem.domain = Rectangle{{number(-1, 1), number(-1, 1)}, {number(0.5, 2), number(0.5, 2)}};
  problem.mesh = {Divisions{5 + choose(12), 5 + choose(12)}, static_cast<Pattern>(choose(4))};
  problem.scheme = static_cast<Scheme>(choose(2));
  problem.material = MembraneStiffness{wave(2, 0.9), wave(0, 0.5), wave(2, 0.9)};
  problem.body = wave(number(-16, -6), 8);
  problem.boundary = {
      {"left", Fixed{wave(0.2, 0.1)}},
      {"bottom", Contact{wave(0.05, 0.05)}},
      {"top", Traction{wave(0, 2)}},
      {"right", choose(2) ? Condition{Contact{wave(0.05, 0.05)}} : Condition{Fixed{wave(0.3, 0.1)}}}};
  return problem;
}

}  // namespace signorini::problems
