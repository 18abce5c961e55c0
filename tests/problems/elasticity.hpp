#pragma once

#include <cmath>
#include <numbers>

#include "problems/membrane.hpp"

/// Elastic problems with known answers, shared by the tests.
namespace signorini::problems {

inline Problem block(Scheme scheme, Pattern pattern, double young, double poisson) {
  Problem problem;
  problem.domain = Rectangle{{0, 0}, {2, 1}};
  problem.mesh = {Divisions{6, 4}, pattern};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(young), Field(poisson), Plane::strain};
  return problem;
}

/// A block on rollers at its left side, pressed on a foundation by the traction (0, −p): σ_yy = −p, all else
/// 0.
inline Problem pressed_block(Scheme scheme, Pattern pattern, double poisson, double p) {
  Problem problem = block(scheme, pattern, 3, poisson);
  problem.boundary = {{"left", Roller{}}, {"bottom", Contact{}}, {"top", Traction{VectorField(0, -p)}}};
  return problem;
}

/// The block with its top lowered by δ over a gap d, rollers on both sides: free while δ < d, then
/// σ_yy = −(δ − d) E' / H with the constrained modulus E'.
inline Problem lowered_block(Scheme scheme, Pattern pattern, double poisson, double gap, double delta) {
  Problem problem = block(scheme, pattern, 3, poisson);
  problem.boundary = {{"left", Roller{}},
                      {"right", Roller{}},
                      {"bottom", Contact{gap}},
                      {"top", Fixed{VectorField(0, -delta)}}};
  return problem;
}

/// An L-shaped body on a foundation, with a roller at its left side, pressed down on its foot's top and
/// pulled at its tip: stress is singular at the inner corner and where the contact opens.
inline Problem pressed_angle(Scheme scheme) {
  Problem problem;
  problem.domain = Polygon{{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},
                           {},
                           {"bottom", "right", "step", "step", "top", "left"}};
  problem.mesh.fineness = LargestEdge{0.5};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  problem.boundary = {{"left", Roller{}},
                      {"bottom", Contact{}},
                      {"top", Traction{VectorField(0, -0.1)}},
                      {"right", Traction{VectorField(0, 0.02)}}};
  return problem;
}

/// A block that hangs from above and sags onto a curved foundation.
inline Problem hanging_block(Scheme scheme, int n) {
  Problem problem;
  problem.scheme = scheme;
  problem.mesh = MeshRequest(Divisions{n, n});
  problem.material = YoungPoisson{Field(200), Field(0.3), Plane::strain};
  problem.body = VectorField(Field(0), Field(-4));
  problem.boundary = {{"top", Fixed{}}, {"bottom", Contact{formula("0.01 * (2*x - 1)^2")}}};
  return problem;
}

/// The lower half of a disc of radius 1, its flat top lowered by 0.02 onto a flat foundation.
inline Problem half_disc(Scheme scheme) {
  constexpr int edges = 64;
  Polygon disc;
  for (int i = 0; i <= edges; ++i) {
    const double angle = std::numbers::pi * (1 + 1. * i / edges);
    disc.vertices.push_back({std::cos(angle), 1 + std::sin(angle)});
    if (i < edges) disc.sides.push_back(std::abs(2 * i + 1 - edges) < 32 ? "arc" : "flank");
  }
  disc.sides.push_back("top");
  Problem problem;
  problem.domain = disc;
  problem.mesh.fineness = LargestEdge{0.3};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  problem.boundary = {{"arc", Contact{formula("y")}}, {"top", Fixed{VectorField(0, -0.02)}}};
  return problem;
}

/// A square with a hole that a foundation overlaps all round, fixed below, on rollers at its left, with a
/// traction on top that jumps in the middle. The hole has three or four corners, or more on a circle.
inline Problem touching_hole(Scheme scheme, double poisson, int corners) {
  std::vector<Point> hole{{0.3, 0.3}, {0.7, 0.3}, {0.5, 0.7}};
  if (corners > 3) hole.clear();
  for (int i = 0; i < corners && corners > 3; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.5) / corners;
    hole.push_back({0.5 + 0.2 * std::cos(angle), 0.5 + 0.2 * std::sin(angle)});
  }
  Problem problem;
  problem.domain = Polygon{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {hole}, {"bottom", "right", "top", "left"}};
  problem.mesh.fineness = LargestEdge{0.25};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(poisson), Plane::strain};
  const Field jump = function([](const Point& x) { return x.x() < 0.5 ? -0.1 : 0.05; });
  problem.boundary = {{"bottom", Fixed{}},
                      {"left", Roller{}},
                      {"top", Traction{VectorField(Field(0.02), jump)}},
                      {"hole0", Contact{-0.01}}};
  return problem;
}

inline double constrained_modulus(double young, double poisson) {
  return young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson));
}

/// Hooke's matrix of an orthotropic material with its axes turned by an angle.
inline HookeTensor orthotropic(double angle) {
  Eigen::Matrix3d hooke;
  hooke << 5, 0.8, 0, 0.8, 2, 0, 0, 0, 0.7;
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix3d turn;  // engineering strains in the material's axes from those in x and y
  turn << c * c, s * s, c * s, s * s, c * c, -c * s, -2 * c * s, 2 * c * s, c * c - s * s;
  const Eigen::Matrix3d h = turn.transpose() * hooke * turn;
  return {{Field(h(0, 0)), Field(h(0, 1)), Field(h(0, 2)), Field(h(1, 1)), Field(h(1, 2)), Field(h(2, 2))}};
}

/// A smooth solution that stays bounded as ν → 1/2: a divergence-free field, plus one over λ.
struct Smooth {
  double mu, lambda;

  explicit Smooth(double poisson)
      : mu(1 / (2 * (1 + poisson))), lambda(poisson / ((1 + poisson) * (1 - 2 * poisson))) {}

  static constexpr double pi = std::numbers::pi;

  Vector u(const Point& p) const {
    const double sx = std::sin(pi * p.x()), sy = std::sin(pi * p.y());
    const double bump = sx * sy / lambda;
    return {sx * sx * std::sin(2 * pi * p.y()) + bump, -sy * sy * std::sin(2 * pi * p.x()) + bump};
  }

  Eigen::Matrix2d gradient(const Point& p) const {
    const double sx = std::sin(pi * p.x()), sy = std::sin(pi * p.y()), cx = std::cos(pi * p.x()),
                 cy = std::cos(pi * p.y());
    const double s2x = std::sin(2 * pi * p.x()), s2y = std::sin(2 * pi * p.y());
    const double c2x = std::cos(2 * pi * p.x()), c2y = std::cos(2 * pi * p.y());
    const double bx = pi * cx * sy / lambda, by = pi * sx * cy / lambda;
    Eigen::Matrix2d g;
    g << pi * s2x * s2y + bx, 2 * pi * sx * sx * c2y + by, -2 * pi * sy * sy * c2x + bx, -pi * s2y * s2x + by;
    return g;
  }

  Eigen::Matrix2d stress(const Point& p) const {
    const Eigen::Matrix2d g = gradient(p);
    return mu * (g + g.transpose()) + lambda * g.trace() * Eigen::Matrix2d::Identity();
  }

  double rotation(const Point& p) const { return 0.5 * (gradient(p)(0, 1) - gradient(p)(1, 0)); }

  /// −div σ = −μ Δu − (λ + μ) ∇ div u.
  Vector body(const Point& p) const {
    const double sx = std::sin(pi * p.x()), sy = std::sin(pi * p.y());
    const double s2x = std::sin(2 * pi * p.x()), s2y = std::sin(2 * pi * p.y());
    const double c2x = std::cos(2 * pi * p.x()), c2y = std::cos(2 * pi * p.y());
    const double bump = -2 * pi * pi * sx * sy / lambda;
    const Vector laplace(2 * pi * pi * c2x * s2y - 4 * pi * pi * sx * sx * s2y + bump,
                         -2 * pi * pi * c2y * s2x + 4 * pi * pi * sy * sy * s2x + bump);
    // div u = (∂_x + ∂_y)(sin πx sin πy) / λ = π sin(π (x + y)) / λ; the rest is free of divergence.
    const double slope = pi * pi * std::cos(pi * (p.x() + p.y())) / lambda;
    return -mu * laplace - (lambda + mu) * Vector(slope, slope);
  }

  /// Fixed on the left and below, traction elsewhere, on n × n squares.
  Problem problem(Scheme scheme, int n) const {
    Problem problem;
    problem.mesh = {Divisions{n, n}, Pattern::right};
    problem.scheme = scheme;
    const double nu = lambda / (2 * (lambda + mu));
    problem.material = YoungPoisson{Field(1), Field(nu), Plane::strain};
    const std::string l = digits(lambda), m = digits(mu), bump = "sin(pi*x)*sin(pi*y)/" + l,
                      slope = "-" + digits(lambda + mu) + "*pi^2*cos(pi*(x+y))/" + l;
    problem.body =
        VectorField(formula("-" + m + "*pi^2*(2*cos(2*pi*x)*sin(2*pi*y)-4*sin(pi*x)^2*sin(2*pi*y)-2*" + bump +
                            ")" + slope),
                    formula("-" + m + "*pi^2*(-2*cos(2*pi*y)*sin(2*pi*x)+4*sin(pi*y)^2*sin(2*pi*x)-2*" +
                            bump + ")" + slope));
    const Fixed fixed{
        VectorField(formula("sin(pi*x)^2*sin(2*pi*y)+" + bump), formula("-sin(pi*y)^2*sin(2*pi*x)+" + bump))};
    const std::string by_x = "pi*cos(pi*x)*sin(pi*y)/" + l, by_y = "pi*sin(pi*x)*cos(pi*y)/" + l,
                      trace = l + "*(" + by_x + "+" + by_y + ")", twist = "pi*sin(2*pi*x)*sin(2*pi*y)",
                      xx = "(2*" + m + "*(" + twist + "+" + by_x + ")+" + trace + ")",
                      yy = "(2*" + m + "*(-" + twist + "+" + by_y + ")+" + trace + ")",
                      xy = "(" + m + "*(2*pi*sin(pi*x)^2*cos(2*pi*y)-2*pi*sin(pi*y)^2*cos(2*pi*x)+" + by_x +
                           "+" + by_y + "))";
    const Traction traction{
        VectorField(formula(xx + "*nx+" + xy + "*ny"), formula(xy + "*nx+" + yy + "*ny"))};
    problem.boundary = {{"left", fixed}, {"bottom", fixed}, {"right", traction}, {"top", traction}};
    return problem;
  }
};

}  // namespace signorini::problems
