// The three iterations against each other, against units, and at their limits.
#include <gtest/gtest.h>

#include <limits>
#include <thread>

#include "contact/active_set.hpp"
#include "contact/mprgp.hpp"
#include "contact/paper_uzawa.hpp"
#include "mesh/domain_mesh.hpp"
#include "norms.hpp"
#include "problems/membrane.hpp"
#include "problems/sanitized.hpp"
#include "result/outcome.hpp"

namespace signorini::methods_test {
namespace {

double relative_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double scale = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
  return scale == 0 ? 0 : (a - b).cwiseAbs().maxCoeff() / scale;
}

Eigen::Map<const Eigen::VectorXd> vector(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

void expect_same_fields(const Solution& a, const Solution& b, double tolerance) {
  EXPECT_LT(relative_difference(a.stress, b.stress), tolerance);
  EXPECT_LT(relative_difference(a.displacement, b.displacement), tolerance);
  EXPECT_LT(relative_difference(a.displacement_at_points, b.displacement_at_points), tolerance);
  double clearance = 0, pressure = 0, largest_clearance = 0, largest_pressure = 0;
  for (std::size_t part = 0; part < a.contact.size(); ++part) {
    const auto la = vector(a.contact[part].clearance), lb = vector(b.contact[part].clearance);
    const auto pa = vector(a.contact[part].pressure), pb = vector(b.contact[part].pressure);
    clearance = std::max(clearance, (la - lb).lpNorm<Eigen::Infinity>());
    pressure = std::max(pressure, (pa - pb).lpNorm<Eigen::Infinity>());
    largest_clearance = std::max(largest_clearance, lb.lpNorm<Eigen::Infinity>());
    largest_pressure = std::max(largest_pressure, pb.lpNorm<Eigen::Infinity>());
  }
  EXPECT_LE(clearance, tolerance * largest_clearance);
  // Where nothing presses, the pressures are rounding of the stress.
  EXPECT_LE(pressure, tolerance * std::max(largest_pressure, b.stress_at_centroids.cwiseAbs().maxCoeff()));
}

/// Opening both unknowns gives λ = (0.5, −2.5e-4): the second must close again, however little it violates.
TEST(ActiveSetMethod, ClosesWhatIsViolatedALittle) {
  const Eigen::MatrixXd s{{2, 1}, {1, 2}};
  const ContactComplement contact{s, Eigen::Vector2d(1, 0.499625), Eigen::Vector2d(1, 1)};
  Observer observer;
  Progress progress(observer, std::nullopt);
  const ContactResult result = active_set(contact, {}, progress);
  EXPECT_EQ(result.outcome, Outcome::converged);
  EXPECT_NEAR(result.clearance[0], 0.5, 1e-14);
  EXPECT_EQ(result.clearance[1], 0);
}

/// S = AᵀA of any sign pattern; with fewer rows than columns it is singular, and c = S x + (pressures where
/// x = 0) has the solution x nevertheless.
TEST(MprgpMethod, FindsTheKnownSolutionFromEveryStart) {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  const auto random = [&](int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); }).eval();
  };
  for (const int n : {1, 2, 3, 10, 40}) {
    for (const int rank : {n, std::max(1, n - 1)}) {
      const Eigen::MatrixXd a = random(rank, n);
      const Eigen::VectorXd x = random(n, 1).cwiseMax(0), p = random(n, 1).cwiseAbs();
      const Eigen::MatrixXd s = a.transpose() * a;
      const Eigen::VectorXd weight = random(n, 1).cwiseAbs();
      const ContactComplement contact{s, s * x - (x.array() > 0).select(0, p.cwiseProduct(weight)), weight};
      for (const bool started : {false, true}) {
        Observer observer;
        Progress progress(observer, std::nullopt);
        Eigen::VectorXd start;
        if (started) start = random(n, 1).cwiseAbs();
        const ContactResult result = mprgp(
            contact, {1e-12, 10000}, progress,
            [](const Eigen::VectorXd&) -> BodyState {
              return {0, {}};
            },
            start);
        ASSERT_EQ(result.outcome, Outcome::converged) << n << ' ' << rank;
        EXPECT_GE(result.clearance.minCoeff(), 0);
        const double scale = (s * x).norm() + contact.c.norm();
        EXPECT_LT((s * (result.clearance - x)).norm(), 1e-8 * scale) << n << ' ' << rank;
      }
    }
  }
}

TEST(MprgpMethod, ItsCountGrowsMoreSlowlyThanTheRootOfTheDivisions) {
  if (sanitized) GTEST_SKIP() << "smaller meshes take the same ways";
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const auto count = [&](int n) {
      return solve(problems::paper(scheme, n), {Mprgp{1e-8}, {}}).summary.iterations;
    };
    const int coarse = count(16), fine = count(128);
    EXPECT_LT(fine, coarse * std::sqrt(128. / 16)) << coarse;
    EXPECT_LE(fine, 40);
  }
}

class RandomProblems : public testing::TestWithParam<unsigned> {};

TEST_P(RandomProblems, UzawaAndActiveSetAgree) {
  const Problem problem = problems::random(GetParam());
  const Solution exact = solve(problem, {ActiveSet{}, {}});
  const Solution uzawa = solve(problem, {Mprgp{1e-12, 100000}, {}});
  ASSERT_EQ(exact.summary.outcome, Outcome::converged);
  ASSERT_EQ(uzawa.summary.outcome, Outcome::converged);
  expect_same_fields(uzawa, exact, 1e-8);
}

TEST_P(RandomProblems, ActiveSetLeavesOnlyRounding) {
  const Residuals residuals = solve(problems::random(GetParam()), {ActiveSet{}, {}}).summary.residuals;
  EXPECT_LT(residuals.equilibrium, 1e-11);
  EXPECT_LT(residuals.constitutive, 1e-11);
  EXPECT_LT(residuals.penetration, 1e-11);
  EXPECT_LT(residuals.tension, 1e-11);
  EXPECT_LT(residuals.complementarity, 1e-11);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomProblems, testing::Range(1u, sanitized ? 4u : 11u));

/// The random problems are of use only if contact is open in one place and closed in another.
TEST(RandomProblemsThemselves, AreNotTrivial) {
  if (sanitized) GTEST_SKIP() << "the tests of random problems solve them too";
  int mixed = 0;
  for (unsigned seed = 1; seed < 11; ++seed) {
    const Solution solution = solve(problems::random(seed), {ActiveSet{}, {}});
    double length = 0;
    for (const ContactPart& part : solution.contact) length += vector(part.weight).sum();
    mixed += solution.summary.contact.length > 0 && solution.summary.contact.length < 0.999 * length;
  }
  EXPECT_GE(mixed, 5);
}

TEST(PaperUzawaMethod, ItsFixedPointIsTheActiveSetSolution) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const Problem problem = problems::paper(scheme, 8);
    const Solution exact = solve(problem, {ActiveSet{}, {}});
    const Solution uzawa = solve(problem, {PaperUzawa{0.1, 1, 0, 1e-14, 100000}, {}});
    ASSERT_EQ(uzawa.summary.outcome, Outcome::converged);
    expect_same_fields(uzawa, exact, 1e-9);
  }
}

TEST(PaperUzawaMethod, DivergesWithoutAugmentationAndSaysSo) {
  for (const int n : {4, 12}) {
    const Solution solution =
        solve(problems::paper(Scheme::conforming, n), {PaperUzawa{0.05, 0, 1, 1e-5, 100000}, {}});
    EXPECT_EQ(solution.summary.outcome, Outcome::diverged);
    EXPECT_NE(solution.summary.advice.find("rho"), std::string::npos);
    EXPECT_TRUE(solution.stress.allFinite());
    EXPECT_TRUE(solution.displacement.allFinite());
    EXPECT_EQ(solution.summary.iterations, static_cast<int>(solution.history.size()));
  }
}

TEST(PaperUzawaMethod, OverflowAtOnceIsAnErrorInWords) {
  try {
    const Solution solution =
        solve(problems::paper(Scheme::conforming, 4), {PaperUzawa{1e308, 0, 1, 1e-5, 10}, {}});
    EXPECT_EQ(solution.summary.outcome, Outcome::diverged);
    EXPECT_TRUE(solution.displacement.allFinite());
  } catch (const SolveError& error) {
    EXPECT_NE(std::string(error.what()).find("double precision"), std::string::npos);
  }
}

TEST(Limits, IterationLimitKeepsTheLastIterate) {
  for (const Method& method : {Method{Mprgp{1e-12, 3}}, Method{PaperUzawa{0.05, 1, 1, 1e-5, 3}}}) {
    const Solution solution = solve(problems::paper(Scheme::conforming, 8), {method, {}});
    EXPECT_EQ(solution.summary.outcome, Outcome::iteration_limit);
    EXPECT_EQ(solution.history.size(), 3u);
    EXPECT_FALSE(solution.summary.advice.empty());
    EXPECT_TRUE(std::isfinite(solution.summary.energy));
  }
}

TEST(Limits, TimeLimitBeforeAnyIterateIsAnError) {
  EXPECT_THROW(solve(problems::paper(Scheme::conforming, 8), {ActiveSet{}, 1e-9}), SolveError);
}

TEST(Limits, TimeLimitKeepsTheLastIterate) {
  const Solution solution =
      solve(problems::paper(Scheme::conforming, 8), {PaperUzawa{1e-9, 1, 1, 1e-14, 1000000}, 0.5});
  EXPECT_EQ(solution.summary.outcome, Outcome::time_limit);
  EXPECT_GT(solution.summary.iterations, 0);
}

/// Lets seconds pass the first time that a method looks at its observer after an iteration.
class Dawdler : public Observer {
 public:
  explicit Dawdler(int seconds) : seconds_(seconds) {}

  void iterated(const Iteration&) override { asked_ = 0; }
  bool keep_going() override {
    const bool in_the_next_iteration = ++asked_ == 2;
    if (in_the_next_iteration) std::this_thread::sleep_for(seconds_);
    return true;
  }

 private:
  const std::chrono::seconds seconds_;
  int asked_ = 2;
};

TEST(Limits, TimeLimitWithinAnIterationKeepsTheOneBefore) {
  constexpr int n = 600;
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  // Coupled like the stiffness of a boundary, and pulled here and there.
  const Eigen::MatrixXd s = Eigen::MatrixXd::NullaryExpr(n, n, [](Eigen::Index i, Eigen::Index j) {
    return i == j ? 4. : -1. / static_cast<double>((i - j) * (i - j));
  });
  const Eigen::VectorXd pull = Eigen::VectorXd::NullaryExpr(n, [&] { return normal(engine); });
  const ContactComplement contact{s, pull, Eigen::VectorXd::Ones(n)};
  const auto expect_iterate = [](const ContactResult& result, const Progress& progress) {
    EXPECT_EQ(result.outcome, Outcome::time_limit);
    EXPECT_EQ(progress.iterations(), 1);
    EXPECT_GT(result.clearance.maxCoeff(), 0);
  };
  Dawdler dawdler(1);
  Progress exact(dawdler, 1.);
  expect_iterate(active_set(contact, {}, exact), exact);
  Progress uzawa(dawdler, 1.);
  const StateOfBody unknown = [](const Eigen::VectorXd&) -> BodyState { return {0, {}}; };
  expect_iterate(mprgp(contact, {1e-12, 10000}, uzawa, unknown), uzawa);
}

TEST(Limits, TimeLimitWithinAnIterationOfThePaperKeepsTheOneBefore) {
  const Problem problem = problems::paper(Scheme::nonconforming, 96);  // a solve looks at the time in between
  constexpr int limit = 4;  // what is before the first iteration takes a second under sanitizers
  const Mesh mesh = make_domain_mesh(problem.domain, problem.mesh);
  const Discretization discrete(problem, mesh);
  const auto iteration_of = [&](int iterations, Progress& progress) {
    return UzawaIteration(discrete, {1e-3, 1, 1, 1e-14, iterations}, Factorization::multifrontal, progress);
  };
  Dawdler dawdler(limit);
  Progress short_of_time(dawdler, limit);
  UzawaIteration late = iteration_of(20, short_of_time);
  EXPECT_EQ(late.run(short_of_time), Outcome::time_limit);
  EXPECT_EQ(short_of_time.iterations(), 1);
  Observer nobody;
  Progress any_time(nobody, std::nullopt);
  UzawaIteration first = iteration_of(1, any_time);
  first.run(any_time);
  EXPECT_TRUE(late.stress() == first.stress());
  EXPECT_TRUE(late.displacement() == first.displacement());
}

/// Takes a moment whenever it is asked after the first iteration.
class Slow : public Observer {
 public:
  static constexpr double kMoment = 0.05;

  void iterated(const Iteration&) override { has_iterate_ = true; }
  bool keep_going() override {
    if (!has_iterate_) return true;
    ++asked_;
    std::this_thread::sleep_for(std::chrono::duration<double>(kMoment));
    return true;
  }
  double seconds() const { return asked_ * kMoment; }

 private:
  bool has_iterate_ = false;
  int asked_ = 0;
};

TEST(Limits, TimeLimitHoldsWhileAnIterateIsCompleted) {
  constexpr double limit = 0.5, beyond = 0.25;
  for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{1e-9, 1}}}) {
    Slow slow;
    try {
      solve(problems::paper(Scheme::nonconforming, 64), {method, limit}, slow);
      ADD_FAILURE() << "there was time enough";
    } catch (const TimeUp& late) {
      EXPECT_NE(std::string(late.what()).find("before the fields of an iterate were known"),
                std::string::npos)
          << late.what();
    }
    EXPECT_LT(slow.seconds(), limit + beyond);
  }
}

/// Found from outside: quantities that ran out of time took what is allowed for the answer twice.
TEST(Limits, APartOfASolveHasNoTimeOfItsOwn) {
  using namespace std::chrono_literals;
  Observer indifferent;
  Progress whole(indifferent, 0.1);
  whole.enter(Phase::certify);
  Progress part(indifferent, whole);
  part.enter(Phase::certify);
  std::this_thread::sleep_for(260ms);  // 0.1 s and what is allowed for the answer
  EXPECT_THROW(part.check(), TimeUp);
  EXPECT_THROW(whole.check(), TimeUp);
}

/// Lets the time run out between the iterate and its bound.
class PausesBeforeTheBound : public Observer {
 public:
  void entered(Phase phase) override {
    if (phase == Phase::certify) std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  }
};

TEST(Limits, TimeLimitBeforeTheBoundKeepsTheSolution) {
  PausesBeforeTheBound observer;
  const Solution solution = solve(problems::paper(Scheme::conforming, 4), {ActiveSet{}, 2.}, observer);
  EXPECT_EQ(solution.summary.outcome, Outcome::time_limit);
  EXPECT_FALSE(solution.summary.error_bound);
  EXPECT_NE(solution.summary.advice.find("solver.time_limit"), std::string::npos) << solution.summary.advice;
  ASSERT_FALSE(solution.summary.notes.empty());
  EXPECT_TRUE(solution.summary.notes.back().starts_with("there is no error bound"))
      << solution.summary.notes.back();
  EXPECT_NEAR(solution.summary.energy,
              solve(problems::paper(Scheme::conforming, 4), {ActiveSet{}, {}}).summary.energy, 1e-12);
}

class Stopper : public Observer {
 public:
  explicit Stopper(int after) : after_(after) {}
  void iterated(const Iteration&) override { ++seen_; }
  bool keep_going() override { return seen_ < after_; }

 private:
  int after_, seen_ = 0;
};

TEST(Observers, CanStopEveryMethod) {
  for (const Method& method :
       {Method{Mprgp{}}, Method{PaperUzawa{0.05, 1, 1, 1e-5, 1000}}, Method{ActiveSet{}}}) {
    Stopper stopper(1);
    EXPECT_THROW(solve(problems::paper(Scheme::conforming, 12), {method, {}}, stopper), Cancelled);
  }
  Stopper at_once(0);
  EXPECT_THROW(solve(problems::paper(Scheme::conforming, 12), {}, at_once), Cancelled);
}

/// The paper's problem with lengths × a, stiffness × b, displacements × c: load × b c / a².
Problem scaled(double a, double b, double c) {
  Problem problem = problems::paper(Scheme::conforming, 12);
  problem.domain = Rectangle{{0, 0}, {a, a}};
  problem.material = MembraneStiffness::isotropic(Field(b));
  const double load = 10 * b * c / (a * a);
  problem.body = problems::function([=](const Point& x) { return x.x() < 0.5 * a ? load : -load; });
  problem.boundary["bottom"] =
      Contact{problems::function([=](const Point& x) { return c * 0.05 * x.x() / a; })};
  return problem;
}

TEST(Units, ChangeNeitherCountsNorTheActiveSet) {
  for (const Method& method : {Method{Mprgp{}}, Method{ActiveSet{}}}) {
    const Solution reference = solve(scaled(1, 1, 1), {method, {}});
    for (const double a : {1e-9, 1., 1e9})
      for (const double b : {1e-9, 1., 1e9})
        for (const double c : {1e-9, 1., 1e9}) {
          if (sanitized && (a == 1 || b == 1 || c == 1)) continue;
          const Solution solution = solve(scaled(a, b, c), {method, {}});
          EXPECT_EQ(solution.summary.outcome, Outcome::converged);
          EXPECT_EQ(solution.summary.iterations, reference.summary.iterations) << a << ' ' << b << ' ' << c;
          for (std::size_t part = 0; part < reference.contact.size(); ++part)
            EXPECT_EQ(solution.contact[part].open, reference.contact[part].open) << a << ' ' << b << ' ' << c;
          EXPECT_NEAR(solution.summary.energy / (b * c * c) / reference.summary.energy, 1, 1e-9);
        }
  }
}

/// A block whose lower right corner lies on contact by two of its sides, with lengths × a: displacements are
/// × a where the load is × 1 / a.
Problem cornered(Scheme scheme, Pattern pattern, Divisions squares, double a) {
  Problem problem;
  problem.domain = Rectangle{{0, 0}, {2 * a, 0.8 * a}};
  problem.mesh = {squares, pattern};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(1), Field(0.3), Plane::strain};
  problem.body = VectorField(-0.003 / a, -0.01 / a);
  problem.boundary = {
      {"left", Fixed{}}, {"bottom", Contact{Field(0.001 * a)}}, {"right", Contact{Field(0.01 * a)}}};
  return problem;
}

/// Found from outside: matrices of triangles on both sides of a corner were taken for one another at lengths
/// from 1e8 on, where the entries of turns are 1e16 times those of displacements.
TEST(Units, OfABodyWithTwoContactsAtACornerChangeNothing) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const Pattern pattern : {Pattern::right, Pattern::left, Pattern::alternating, Pattern::crossed})
      for (const Divisions squares : {Divisions{2, 2}, Divisions{3, 3}, Divisions{8, 5}}) {
        const Solution reference = solve(cornered(scheme, pattern, squares, 1), {ActiveSet{}, {}});
        ASSERT_EQ(reference.summary.outcome, Outcome::converged);
        for (const double a : {1e-10, 1e-9, 1e8, 1e9, 1e10}) {
          const Solution solution = solve(cornered(scheme, pattern, squares, a), {ActiveSet{}, {}});
          EXPECT_EQ(solution.summary.outcome, Outcome::converged) << a;
          EXPECT_EQ(solution.summary.iterations, reference.summary.iterations) << a;
          EXPECT_LT(relative_difference(solution.stress / a, reference.stress), 1e-8) << a;
          EXPECT_NEAR(solution.summary.error_bound->relative / reference.summary.error_bound->relative, 1,
                      1e-4)
              << a;
        }
      }
}

TEST(Units, PaperFormScalesWithItsParameters) {
  const Solution reference = solve(scaled(1, 1, 1), {PaperUzawa{0.05, 1, 0.3, 1e-5, 1000}, {}});
  // With lengths fixed, ρ and r scale like 1 / modulus.
  for (const double b : {1e-9, 1e9}) {
    const Solution solution =
        solve(scaled(1, b, 1e-9), {PaperUzawa{0.05 / b, 1 / b, 0.3e-9, 1e-5, 1000}, {}});
    EXPECT_EQ(solution.summary.iterations, reference.summary.iterations);
  }
}

/// Whoever reads the history as it grows gets numbers.
TEST(Methods, ShowNoRowThatIsNotFinite) {
  struct Reader : Observer {
    void iterated(const Iteration& row) override {
      for (const double number :
           {row.clearance_change, row.equilibrium, row.penetration, row.tension, row.complementarity})
        EXPECT_TRUE(std::isfinite(number)) << row.number;
    }
  } reader;
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming})
    for (const double size : {1e150, 1e290, 1e299, 1e308})
      for (const Settings& settings :
           {Settings{ActiveSet{}, {}}, Settings{Mprgp{}, {}}, Settings{PaperUzawa{0.1, 1}, {}}}) {
        Problem problem = problems::paper(scheme, 6);
        problem.body = VectorField(-size);
        problem.boundary = {{"left", Fixed{}}, {"bottom", Contact{Field(size / 10)}}};
        try {
          solve(problem, settings, reader);
        } catch (const SolveError&) {
          // It may say so instead.
        }
      }
}

/// Found from outside: the active set was advised to itself.
TEST(Limits, AreFollowedByAdviceThatHelps) {
  const Settings exact{ActiveSet{}, {}}, uzawa{Mprgp{}, {}};
  const auto says = [](const Settings& settings, Outcome outcome, const std::string& word) {
    return advice(settings, outcome, 3).find(word) != std::string::npos;
  };
  for (const Outcome outcome : {Outcome::time_limit, Outcome::iteration_limit}) {
    EXPECT_FALSE(says(exact, outcome, "active_set"));
    EXPECT_TRUE(says(uzawa, outcome, "active_set"));
  }
  for (const Settings& settings : {exact, uzawa}) {
    EXPECT_FALSE(says(settings, Outcome::time_limit, "max_iterations"));
    EXPECT_TRUE(says(settings, Outcome::iteration_limit, "max_iterations"));
  }
}

/// Counts how often it is asked, and takes a moment each time after so many.
class SlowAfter : public Observer {
 public:
  explicit SlowAfter(int asked) : at_once_(asked) {}

  bool keep_going() override {
    if (++asked_ > at_once_) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return true;
  }
  int asked() const { return asked_; }

 private:
  const int at_once_;
  int asked_ = 0;
};

TEST(Limits, QuantitiesThatAreLateLeaveTheBound) {
  Problem problem = problems::paper(Scheme::conforming, 8);
  problem.quantities.clear();
  SlowAfter without(std::numeric_limits<int>::max());
  const Solution bounded = solve(problem, {ActiveSet{}, {}}, without);
  for (int i = 0; i < 50; ++i) {
    Quantity& quantity = problem.quantities.emplace_back();
    quantity.name = "force " + std::to_string(i);
    quantity.weights.emplace("bottom", Field(1 + i));
  }
  SlowAfter slow(without.asked());
  const Solution late = solve(problem, {ActiveSet{}, 2.}, slow);
  EXPECT_EQ(late.summary.outcome, Outcome::time_limit);
  EXPECT_NE(late.summary.advice.find("quantities"), std::string::npos) << late.summary.advice;
  EXPECT_TRUE(late.summary.quantities.empty());
  ASSERT_TRUE(late.summary.error_bound);
  EXPECT_NEAR(late.summary.error_bound->value, bounded.summary.error_bound->value,
              1e-9 * bounded.summary.error_bound->value);
}

}  // namespace
}  // namespace signorini::methods_test
