// The sums over the mesh: of the triangles, of Γ_C and of Γ_F, each as THEORY.md has it.

#include "certify/totals.hpp"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

#include "certificate_fields.hpp"
#include "certify/data/oscillation.hpp"
#include "mesh/rectangle.hpp"
#include "problems/membrane.hpp"

namespace signorini::totals_test {
namespace {

/// A load that jumps within triangles, a law that waves, a traction, and a gap that bends.
Problem membrane(const std::string& load) {
  Problem problem;
  problem.scheme = Scheme::conforming;
  problem.material = MembraneStiffness::isotropic(problems::formula("1 + 0.5*sin(9*x)"));
  problem.body = problems::formula(load);
  problem.boundary = {{"left", Fixed{}},
                      {"bottom", Contact{problems::formula("0.02 + 0.03*x^2")}},
                      {"top", Traction{problems::formula("x^2 - 0.4")}}};
  return problem;
}

std::shared_ptr<const Mesh> squares(int n) {
  return std::make_shared<const Mesh>(rectangle_mesh(Rectangle{}, {n, n}, Pattern::right));
}

/// f(i, s) over all contact edges i.
template <typename Function>
double integrate_over_contact(const CertificateFields& fields, const Function& f) {
  double sum = 0;
  for (int i = 0; i < static_cast<int>(fields.contact_edges().size()); ++i) {
    const auto& [a, b] = fields.mesh().edges[fields.contact_edges()[i].edge];
    sum +=
        integrate_from(fields.mesh().points[a], fields.mesh().points[b], [&](double s) { return f(i, s); });
  }
  return sum;
}

struct Made {
  explicit Made(CertificateFields& of)
      : fields(of),
        laws(of.discretization().problem.material, of.mesh(), 0.3, of.progress()),
        sums(of.discretization(), of.solution().stress, of.pair(), norms),
        totals(of.discretization().triangles()) {
    Owners owners(of.discretization().triangles());
    std::iota(owners.begin(), owners.end(), 0);
    totals.add<1>(of.discretization(), laws, of.pair(), sums, owners, of.progress());
  }

  CertificateFields& fields;
  LawOnMesh laws;
  ShapeNorms norms;
  MembraneSums sums;
  Totals totals;
};

TEST(Totals, AreTheSumsOfTheTheorem) {
  const Problem problem = membrane("(x - 0.45)^2 + (y - 0.55)^2 < 0.083 ? 10 : -10");
  CertificateFields fields(problem, squares(3));
  const Made made(fields);
  LawField<1> law(problem.material);
  TriangleSums all;
  double gap = 0, correction = 0, oscillation_square = 0, of_oscillation = 0;
  for (int t = 0; t < fields.discretization().triangles(); ++t) {
    const TriangleSums own = made.sums(t, law, made.laws);
    CellBudget budget{20'000, &fields.progress()};
    const double o =
        oscillation<1>(fields.discretization(), t, load_remainder<1>(fields.discretization(), t, budget),
                       fields.pair().pressure, made.laws);
    EXPECT_GT(own.slack, 0);
    all += own;
    gap += std::pow(std::sqrt(own.gap + own.slack) + o, 2);
    correction += std::pow(std::sqrt(own.correction + own.slack) + o, 2);
    oscillation_square += o * o;
    of_oscillation += 3 * o * std::sqrt(own.slack);  // of K_τ, where there is no second pair
  }
  EXPECT_GT(oscillation_square, 1e-3 * gap);
  // A load that jumps has a budget, which the triangles share.
  EXPECT_NEAR(made.totals.oscillation_square, oscillation_square, 0.01 * oscillation_square);
  EXPECT_NEAR(made.totals.balanced_gap, gap, 1e-3 * gap);
  EXPECT_NEAR(made.totals.balanced_correction, correction, 1e-3 * correction);
  EXPECT_NEAR(made.totals.all.known, of_oscillation, 0.01 * of_oscillation);
  const double contact = 2 * integrate_over_contact(fields, [&](int i, double s) {
                           return fields.pressure(i, s) * fields.room(i, s);
                         });
  EXPECT_GT(contact, 1e-6 * all.stress);
  EXPECT_NEAR(made.totals.contact, contact, 1e-9 * all.stress);
  double work = 0, work_without_signs = 0;
  for (int edge = 0; edge < static_cast<int>(fields.mesh().edges.size()); ++edge) {
    if (!fields.discretization().traction.acts_on(edge)) continue;
    const auto& [a, b] = fields.mesh().edges[edge];
    const Point &from = fields.mesh().points[a], &to = fields.mesh().points[b];
    const auto own = [&](double s) {
      const double x = from.x() + s * (to.x() - from.x());
      return (x * x - 0.4) * fields.pair().v.on_edge(edge, s)[0];
    };
    work += integrate_from(from, to, own);
    work_without_signs += integrate_from(from, to, [&](double s) { return std::abs(own(s)); });
  }
  EXPECT_NEAR(made.totals.all.energy, all.energy - work, 1e-9 * all.strain);
  EXPECT_NEAR(made.totals.work, work_without_signs, 0.1 * work_without_signs);
}

/// Γ_C against another pair, of half the pressure and a displacement that leaves the gap.
TEST(Totals, HaveTheContactTermsAgainstASecondPair) {
  const Problem problem = membrane("-10");
  CertificateFields fields(problem, squares(3));
  AdmissiblePair second{{fields.discretization(), fields.solution(),
                         Eigen::VectorXd::Zero(fields.discretization().traces.unknowns()), fields.progress()},
                        fields.pair().pressure};
  for (auto& ends : second.pressure.at_ends)
    for (double& end : ends) end /= 2;
  Owners owners(fields.discretization().triangles());
  std::iota(owners.begin(), owners.end(), 0);
  const LawOnMesh laws(problem.material, fields.mesh(), 1e-8, fields.progress());
  Totals totals(fields.discretization().triangles());
  ShapeNorms norms;
  totals.add<1>(fields.discretization(), laws, fields.pair(),
                MembraneSums(fields.discretization(), fields.solution().stress, fields.pair(), norms), owners,
                fields.progress(), &second);
  const auto room_of_second = [&](int i, double s) { return second.v.room(fields.contact_edges()[i], s); };
  const double first_by_second =
                   2 *
                   integrate_over_contact(
                       fields, [&](int i, double s) { return fields.pressure(i, s) * room_of_second(i, s); }),
               own = 2 * integrate_over_contact(fields, [&](int i, double s) {
                       return fields.pressure(i, s) * fields.room(i, s);
                     });
  EXPECT_GT(first_by_second, 0.5 * own);
  EXPECT_NEAR(totals.all.known, first_by_second + own / 2 - 2 * own, 1e-6 * first_by_second);
}

/// Of a gap with more waves than cells no more is known than where it lies, and its upper end counts: its
/// mean is larger than what lies in the middle.
TEST(Totals, CountTheLargestGapThatIsPossible) {
  Problem problem = membrane("-10");
  problem.boundary["bottom"] = Contact{problems::formula("0.1 + 0.05*abs(sin(1000000*x))")};
  CertificateFields fields(problem, squares(3));
  const Made made(fields);
  constexpr double mean = 0.1 + 0.05 * 2 / std::numbers::pi;
  const double contact = 2 * integrate_over_contact(fields, [&](int i, double s) {
                           const double v_n = fields.pair().v.along_contact(fields.contact_edges()[i], s);
                           return fields.pressure(i, s) * (mean - v_n);
                         });
  EXPECT_GT(contact, 0);
  EXPECT_GE(made.totals.contact, contact);
}

/// What the pressure has to take of uncertain loads makes the contact term larger, and no second pair has it.
TEST(Totals, HaveWhatCarriesUncertainLoads) {
  Totals held(0), taken(0);
  held.contact = taken.contact = 2;
  held.add(CarriedLoads{.norm = 3, .loads = UncertainLoads({}), .norm_on_patches = 0.5});
  EXPECT_EQ(held.contact, 2);
  EXPECT_EQ(held.carried, 3.5);
  EXPECT_TRUE(held.second_counts);
  taken.add(CarriedLoads{.norm = 3, .change_of_pressure = 0.25, .loads = UncertainLoads({})});
  EXPECT_EQ(taken.contact, 2.5);
  EXPECT_EQ(taken.carried, 3);
  EXPECT_FALSE(taken.second_counts);
}

}  // namespace
}  // namespace signorini::totals_test
