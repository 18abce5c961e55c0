// Lemma 2: what one triangle's load and tractions have beyond their projections.

#include "certify/data/oscillation.hpp"

#include <gtest/gtest.h>

#include "certify/data/linear_remainder.hpp"
#include "fem/triangle_pieces.hpp"
#include "mesh/rectangle.hpp"
#include "no_pressure.hpp"
#include "problems/elasticity.hpp"

namespace signorini::oscillation_test {
namespace {

constexpr double kSide = 0.5;

/// ‖x³ − Π₂ x³‖ on a half square of the side a, a leg along x: x is a λ of one of its corners but for a
/// constant, and ‖λ³ − Π₂ λ³‖ = √2 / 140 on the reference triangle.
const double kCubeOnTriangle = std::pow(kSide, 4) * std::sqrt(2.) / 140;
/// The same on an edge of that length: 1/20 of Legendre's polynomial, whose norm is 1 / √7.
const double kCubeOnEdge = std::pow(kSide, 3.5) / 20 / std::sqrt(7.);

Problem with_cubes(const Material& material, int components) {
  const auto along = [&](const std::string& text) {
    return components == 1 ? VectorField(problems::formula(text))
                           : VectorField(Field(0), problems::formula(text));
  };
  Problem problem;
  problem.mesh = {Divisions{2, 2}, Pattern::right};
  problem.material = material;
  problem.body = along("5*x^3");
  problem.boundary = {{"left", Fixed{}}, {"top", Traction{along("8*x^3")}}, {"bottom", Contact{Field(1)}}};
  return problem;
}

/// With a pressure on the first contact edge that is so far from its linear one.
constexpr double kSteep = 0.37;

template <int D>
void expect_oscillation(const Material& material, double softest) {
  const Problem problem = with_cubes(material, D);
  const Mesh mesh = rectangle_mesh(Rectangle{}, {2, 2}, Pattern::right);
  const Discretization discretization(problem, mesh);
  Observer observer;
  Progress progress(observer, std::nullopt);
  const LawOnMesh laws(problem.material, mesh, 1e-8, progress);
  ContactPressure pressure = no_pressure(discretization);
  const int pressed = discretization.clearance.edges[0].edge;
  pressure.steep[pressed] = {{pressed, {0, 0}}, kSteep};
  int loaded = 0;
  for (int t = 0; t < discretization.triangles(); ++t) {
    const auto corners = mesh.corners(t);
    double sum = 5 * kCubeOnTriangle * linear_remainder<D>(corners);
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh.triangle_edges[t][e];
      const double rest = discretization.traction.acts_on(edge) ? 8 * kCubeOnEdge
                          : edge == pressed                     ? kSteep
                                                                : 0;
      loaded += rest > 0;
      sum += rest * linear_remainder_on_edge<D>(corners, e);
    }
    CellBudget budget{1000, &progress};
    const double said = oscillation<D>(discretization, t, load_remainder<D>(discretization, t, budget),
                                       pressure, laws),
                 exact = std::sqrt(softest) * sum;
    EXPECT_GE(said, exact * (1 - 1e-9));
    EXPECT_LE(said, exact * (1 + 1e-6));
  }
  EXPECT_EQ(loaded, 3);
}

TEST(Oscillation, IsThatOfLoadTractionAndSteepPressureOnAMembrane) {
  expect_oscillation<1>(MembraneStiffness{Field(2), Field(0), Field(0.5)}, 2);
}

TEST(Oscillation, IsThatOfLoadTractionAndSteepPressureOnAnElasticBody) {
  expect_oscillation<2>(YoungPoisson{Field(2), Field(0.3), Plane::strain}, 1.3 / 2);
}

}  // namespace
}  // namespace signorini::oscillation_test
