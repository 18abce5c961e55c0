// The entries of a sweep are the answers of single solves.
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "problems/families.hpp"
#include "problems/sanitized.hpp"
#include "progress/helpers.hpp"

namespace signorini::sweep_test {
namespace {

Variation data_of(const Problem& problem, std::string load_key) {
  return {"", problem.body, problem.boundary, std::move(load_key)};
}

Solution solve_sweep(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings,
                     Observer& observer) {
  problems::Shelf shelf;
  return solve(problem, sweep, settings, observer, shelf);
}

Solution solve_sweep(const Problem& problem, const std::vector<Variation>& sweep, const Settings& settings) {
  Observer indifferent;
  return solve_sweep(problem, sweep, settings, indifferent);
}

double largest(const std::vector<double>& numbers) {
  double size = 0;
  for (const double number : numbers) size = std::max(size, std::abs(number));
  return size;
}

/// Numbers that may be far apart by `tolerance` times their largest, or times the scale if that is larger.
void expect_near(const std::vector<double>& found, const std::vector<double>& expected, double tolerance,
                 double scale) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    ASSERT_NEAR(found[i], expected[i], tolerance * std::max(largest(expected), scale)) << i;
}

void expect_entry(const SweepEntry& entry, const Solution& expected, double tolerance) {
  ASSERT_EQ(entry.error, "");
  EXPECT_EQ(entry.outcome, expected.summary.outcome);
  EXPECT_NEAR(entry.energy, expected.summary.energy, tolerance * std::abs(expected.summary.energy));
  EXPECT_LT(std::max({entry.penetration, entry.tension, entry.complementarity}), 1e-8);
  double force = 0;
  for (const Reaction& reaction : expected.summary.parts)
    force = std::max({force, largest(reaction.force), std::abs(reaction.moment)});
  ASSERT_EQ(entry.parts.size(), expected.summary.parts.size());
  for (std::size_t i = 0; i < entry.parts.size(); ++i) {
    EXPECT_EQ(entry.parts[i].part, expected.summary.parts[i].part);
    expect_near(entry.parts[i].force, expected.summary.parts[i].force, tolerance, force);
    EXPECT_NEAR(entry.parts[i].moment, expected.summary.parts[i].moment, tolerance * force);
  }
  EXPECT_NEAR(entry.sums.force, expected.summary.contact.force, tolerance * force);
  EXPECT_NEAR(entry.sums.max_pressure, expected.summary.contact.max_pressure, tolerance * force);
  ASSERT_EQ(entry.contact.size(), expected.contact.size());
  for (std::size_t i = 0; i < entry.contact.size(); ++i) {
    const ContactPart &found = entry.contact[i], &part = expected.contact[i];
    EXPECT_EQ(found.points, part.points);
    EXPECT_EQ(found.gap, part.gap);
    expect_near(found.clearance, part.clearance, tolerance, 0);
    expect_near(found.pressure, part.pressure, tolerance, force);
  }
  if (!entry.error_bound) return;
  EXPECT_NEAR(entry.error_bound->value, expected.summary.error_bound->value,
              tolerance * std::sqrt(std::abs(expected.summary.energy)));
  EXPECT_EQ(entry.error_bound->guaranteed, expected.summary.error_bound->guaranteed);
}

/// Constant, linear and curved gaps, and every third time other loads.
std::vector<Problem> variations_of(const Problem& family) {
  std::vector<Problem> variations;
  std::mt19937 engine(7);
  std::uniform_real_distribution<> number(0, 0.1);
  for (unsigned i = 0; i < (sanitized ? 3 : 9); ++i) {
    Problem problem = problems::with_other_data(family, i / 3);
    problem.load_key = std::to_string(i / 3);
    for (auto& [part, condition] : problem.boundary)
      if (auto* contact = std::get_if<Contact>(&condition)) {
        const double a = number(engine), b = number(engine);
        if (i % 3 == 0) contact->gap = a + 0.1;
        if (i % 3 == 1)
          contact->gap = problems::function([=](const Point& x) { return a + 0.1 + b * x.x() - a * x.y(); });
        if (i % 3 == 2) contact->gap = problems::wave(engine, 0.2, 0.1);
      }
    variations.push_back(problem);
  }
  return variations;
}

TEST(Sweep, EntriesAreSingleSolves) {
  const std::vector<Problem> families = problems::families();
  for (std::size_t number = 0; number < families.size(); number += sanitized ? 5 : 1) {
    Problem family = problems::with_other_data(families[number], 17);
    family.operator_key = "family";
    const std::vector<Problem> single = variations_of(family);
    std::vector<Variation> sweep;
    for (const Problem& problem : single) sweep.push_back(data_of(problem, problem.load_key));
    const Solution solution = solve_sweep(family, sweep, {ActiveSet{}, {}});
    ASSERT_EQ(solution.sweep.size(), single.size());
    for (std::size_t i = 0; i < single.size(); i += sanitized ? 2 : 1) {
      expect_entry(solution.sweep[i], solve(single[i], {ActiveSet{}, {}}), 1e-10);
      // Every third has other loads.
      EXPECT_TRUE(solution.sweep[i].error_bound || i % 3 != 0) << i;
    }
    EXPECT_EQ(solution.summary.energy, solve(family, {ActiveSet{}, {}}).summary.energy);
  }
}

/// A fixed side ends where the contact begins, without a gap there: the node bears the support's force.
TEST(Sweep, KnowsTheForceOnNodesThatAreHeld) {
  Problem membrane = problems::paper(Scheme::conforming, 8);
  membrane.body = Field(-10);
  Problem elastic = problems::elastic(Scheme::conforming, 0.3);
  elastic.body = VectorField(0, -2);
  elastic.boundary = {{"left", Fixed{}}, {"bottom", Contact{0, Vector(0.3, -1)}}};
  for (Problem& family : std::array{membrane, elastic}) {
    std::vector<Problem> single(4, family);
    std::vector<Variation> sweep;
    for (std::size_t i = 0; i < single.size(); ++i) {
      const double slope = 0.01 * static_cast<double>(i);
      std::get<Contact>(single[i].boundary["bottom"]).gap =
          problems::function([=](const Point& x) { return slope * x.x(); });
      sweep.push_back(data_of(single[i], "loads"));
    }
    const Solution solution = solve_sweep(family, sweep, {ActiveSet{}, {}});
    for (std::size_t i = 0; i < single.size(); ++i) {
      const Solution expected = solve(single[i], {ActiveSet{}, {}});
      EXPECT_GT(std::abs(expected.contact[0].pressure[0]), 0.1);
      expect_entry(solution.sweep[i], expected, 1e-10);
    }
  }
}

/// How often a sweep over the gaps evaluates the body load, which new gaps do not ask for.
std::size_t loads_evaluated(Scheme scheme, const std::vector<Field>& gaps) {
  std::size_t evaluated = 0;
  Problem problem = problems::paper(scheme, 6);
  problem.body = problems::function([&](const Point&) { return ++evaluated, -10.; });
  problem.load_key = "loads";
  std::vector<Variation> sweep;
  for (const Field& gap : gaps) {
    problem.boundary["bottom"] = Contact{gap};
    sweep.push_back(data_of(problem, "loads"));
  }
  // The certificate of the problem itself looks at the load where contact ends.
  problem.boundary["bottom"] = Contact{0.1};
  solve_sweep(problem, sweep, {ActiveSet{}, {}});
  return evaluated;
}

TEST(Sweep, NewGapsCostNoPassOverTheTriangles) {
  const Field linear = problems::function([](const Point& x) { return 0.3 * x.x(); });
  const Field curved = problems::function([](const Point& x) { return std::exp(x.x()); });
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    const std::size_t once = loads_evaluated(scheme, {0.1});
    EXPECT_EQ(loads_evaluated(scheme, {0.1, 0.2, linear, 3., linear}), once);
    // The clearance of the conforming scheme is linear on an edge.
    EXPECT_EQ(loads_evaluated(scheme, {0.1, curved}) > once, scheme == Scheme::conforming);
  }
}

TEST(Sweep, EveryMethodMaySweep) {
  const Problem family = problems::paper(Scheme::conforming, 8);
  std::vector<Variation> sweep;
  std::vector<Problem> single;
  for (const double gap : {0., 0.05, 0.2, 3.}) {
    Problem problem = family;
    problem.boundary["bottom"] = Contact{gap};
    single.push_back(problem);
    sweep.push_back(data_of(problem, "loads"));
  }
  for (const Method& method :
       {Method{ActiveSet{}}, Method{Mprgp{1e-12, 100000}}, Method{PaperUzawa{0.1, 1, 0, 1e-13, 100000}}}) {
    const Solution solution = solve_sweep(family, sweep, {method, {}});
    for (std::size_t i = 0; i < single.size(); ++i)
      expect_entry(solution.sweep[i], solve(single[i], {ActiveSet{}, {}}), 1e-7);
  }
}

/// Other materials of a family, two entries of each, the second with other gaps; in between the family's own.
std::vector<Problem> material_variations_of(const Problem& family) {
  const Field varying = problems::function([](const Point& x) { return 2 + std::sin(x.x() + 3 * x.y()); });
  std::vector<Material> materials{family.material};
  if (components(family.material) == 1)
    materials.insert(materials.end(),
                     {MembraneStiffness::isotropic(2.5), MembraneStiffness{2, 0.5, varying}});
  else
    materials.insert(materials.end(), {YoungPoisson{7, 0.49, Plane::stress}, YoungPoisson{varying, 0.2}});
  materials.push_back(family.material);
  std::vector<Problem> variations;
  for (const Material& material : materials)
    for (const double gap : {0.01, 0.03}) {
      Problem problem = family;
      problem.material = material;
      for (auto& [part, condition] : problem.boundary)
        if (auto* contact = std::get_if<Contact>(&condition)) contact->gap = gap;
      variations.push_back(problem);
    }
  return variations;
}

TEST(Sweep, EntriesOfOtherMaterialsAreSingleSolves) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem pressed = problems::elastic(scheme, 0.3);
    pressed.body = VectorField(0, -2);
    Problem contact_alone = problems::paper(scheme, 6);
    contact_alone.boundary = {{"bottom", Contact{}}, {"top", Contact{}}};
    contact_alone.body = Field(-1);
    for (Problem family : std::array{problems::paper(scheme, 6), pressed, contact_alone}) {
      const std::vector<Problem> single = material_variations_of(family);
      for (const bool with_keys : {true, false}) {
        std::vector<Variation> sweep;
        for (std::size_t i = 0; i < single.size(); ++i) {
          sweep.push_back(data_of(single[i], "loads"));
          if (i < 2 || i + 2 >= single.size()) continue;
          sweep.back().material = std::make_shared<const Material>(single[i].material);
          if (with_keys) sweep.back().material_key = std::to_string(i / 2);
        }
        EXPECT_EQ(operators_of(sweep), with_keys ? 3u : 5u);
        const Solution solution = solve_sweep(family, sweep, {ActiveSet{}, {}});
        for (std::size_t i = 0; i < single.size(); i += sanitized ? 3 : 1)
          expect_entry(solution.sweep[i], solve(single[i], {ActiveSet{}, {}}), 1e-10);
        if (sanitized) break;
      }
    }
  }
}

/// Loads take a forward and a backward solve and a bound, gaps a dense step.
TEST(Sweep, OfLoadsIsForeseenToTakeLongerThanOneOfGaps) {
  Problem problem = problems::paper(Scheme::nonconforming, 32);
  problem.load_key = "own";
  const double alone = estimate(problem).seconds;
  const auto seconds = [&](const std::string& load_key) {
    std::vector<Variation> sweep(100, data_of(problem, load_key));
    for (std::size_t i = 0; i < sweep.size(); i += 2) sweep[i].load_key = load_key + "'";
    return estimate(problem, sweep, {}, {}).problem.seconds;
  };
  EXPECT_GE(seconds("other"), 30 * alone);
  const std::vector<Variation> gaps(100, data_of(problem, "own"));
  EXPECT_LE(estimate(problem, gaps, {}, {}).problem.seconds, 5 * alone);
}

TEST(Sweep, AMaterialThatIsNoneFailsAloneOrIsRefusedBefore) {
  Problem problem = problems::paper(Scheme::nonconforming, 6);
  std::vector<Variation> sweep(3, data_of(problem, "loads"));
  // Positive in the middle of each triangle of the coarse mesh that is looked at beforehand.
  const auto thin = [](const Point& x, const Vector&) { return std::abs(x.x() - 1. / 18) < 1e-3 ? -1. : 1.; };
  sweep[1].material = std::make_shared<const Material>(
      MembraneStiffness::isotropic(Field(thin, "/sweep/1/material/stiffness")));
  const auto bad = [&] { return solve_sweep(problem, sweep, {ActiveSet{}, {}}); };
  std::string found;
  try {
    const Solution solution = bad();
    found = solution.sweep[1].error;
    EXPECT_EQ(solution.sweep[0].error + solution.sweep[2].error, "");
  } catch (const InvalidProblem& invalid) {
    found = invalid.faults().front().where;
  }
  EXPECT_NE(found.find("/material/stiffness"), std::string::npos) << found;
  sweep[1].material = std::make_shared<const Material>(MembraneStiffness{1, 2, 1});
  try {
    bad();
    FAIL();
  } catch (const InvalidProblem& invalid) {
    EXPECT_TRUE(invalid.faults().front().where.starts_with("/sweep/1/material"))
        << invalid.faults().front().where;
  }
}

TEST(Sweep, AnEntryWithoutSolutionSaysWhyAndTheOthersGoOn) {
  Problem resting = problems::paper(Scheme::nonconforming, 6);
  resting.boundary = {{"bottom", Contact{}}};
  resting.body = Field(-1);
  std::vector<Variation> sweep(3, data_of(resting, "down"));
  sweep[1].body = Field(1);
  sweep[1].load_key = "up";
  const Solution solution = solve_sweep(resting, sweep, {ActiveSet{}, {}});
  EXPECT_EQ(solution.sweep[0].error, "");
  EXPECT_NE(solution.sweep[1].error.find("lifts it off"), std::string::npos);
  EXPECT_EQ(solution.sweep[2].error, "");
  EXPECT_NEAR(solution.sweep[2].sums.force, 1, 1e-11);
}

TEST(Sweep, RefusesEveryBadVariationAtOnce) {
  Problem problem = problems::paper(Scheme::conforming, 6);
  std::vector<Variation> sweep(4, data_of(problem, "loads"));
  sweep[1].boundary["top"] =
      Contact{Field([](const Point&, const Vector&) { return NAN; }, "/sweep/1/boundary/top/gap")};
  sweep[3].boundary["bottom"] = Contact{-1};
  try {
    solve_sweep(problem, sweep, {});
    FAIL();
  } catch (const InvalidProblem& invalid) {
    ASSERT_EQ(invalid.faults().size(), 2u);
    EXPECT_EQ(invalid.faults()[0].where, "/sweep/1/boundary/top/gap");
    EXPECT_EQ(invalid.faults()[1].where, "/sweep/3/boundary/bottom/gap");
  }
}

/// Keeps what it is shown of entries.
class Seer : public Observer {
 public:
  bool sees_entries() const override { return true; }
  void entry(std::size_t number, const Solution& solution) override { seen.emplace_back(number, solution); }

  std::vector<std::pair<std::size_t, Solution>> seen;
};

TEST(Sweep, ShowsTheFieldsOfItsEntriesToWhoWantsThem) {
  Problem family = problems::paper(Scheme::conforming, 6);
  family.boundary = {{"bottom", Contact{}}};
  family.body = Field(-1);
  std::vector<Problem> single(4, family);
  std::vector<Variation> sweep;
  for (std::size_t i = 0; i < single.size(); ++i) {
    single[i].boundary["bottom"] = Contact{0.1 * static_cast<double>(i)};
    if (i == 2) single[i].body = Field(1);  // lifts it off
    sweep.push_back(data_of(single[i], i == 2 ? "up" : "down"));
  }
  for (const Method& method : {Method{ActiveSet{}}, Method{Mprgp{1e-12}}}) {
    Seer seer;
    const Solution solution = solve_sweep(family, sweep, {method, {}}, seer);
    EXPECT_NE(solution.sweep[2].error, "");
    std::vector<std::size_t> numbers;
    for (const auto& [number, shown] : seer.seen) {
      numbers.push_back(number);
      const Solution expected = solve(single[number], {method, {}});
      expect_entry(solution.sweep[number], shown, 1e-10);
      EXPECT_TRUE(solution.sweep[number].error_bound);
      EXPECT_LT((shown.displacement - expected.displacement).norm(), 1e-7 * expected.displacement.norm());
    }
    EXPECT_EQ(numbers, (std::vector<std::size_t>{0, 1, 3}));
  }
}

TEST(Sweep, ThePapersIterationShowsTheFieldsOfItsEntriesToo) {
  Problem family = problems::paper(Scheme::nonconforming, 4);
  const Settings settings{PaperUzawa{0.1, 1, 0, 1e-13, 100000}, {}};
  Seer seer;
  const Solution solution = solve_sweep(family, {data_of(family, "loads")}, settings, seer);
  ASSERT_EQ(seer.seen.size(), 1u);
  expect_entry(solution.sweep[0], seer.seen[0].second, 1e-10);
  EXPECT_TRUE(solution.sweep[0].error_bound);
}

/// Ends the job after so many entries.
class StopsAfter : public Observer {
 public:
  explicit StopsAfter(std::size_t entries) : entries_(entries) {}
  void swept(std::size_t done, std::size_t count) override {
    done_ = done;
    EXPECT_EQ(count, 5u);
  }
  bool keep_going() override { return done_ < entries_; }
  std::size_t done() const { return done_; }

 private:
  std::size_t entries_, done_ = 0;
};

/// Solves the pieces between starts by itself, the last one first.
class Backwards : public Helpers {
 public:
  Backwards(std::size_t alone, std::size_t entries) : alone_(alone), entries_(entries) {}

  std::size_t join(std::size_t next, const FindStarts& starts) override {
    if (next == alone_) starts_ = starts();
    return starts_.empty() ? none : starts_.front();
  }
  std::vector<SweepEntry> solve(std::size_t first, const SolveEntries& here) override {
    std::vector<SweepEntry> all(entries_ - first);
    for (std::size_t i = starts_.size(); i-- > 0;) {
      const std::size_t end = i + 1 < starts_.size() ? starts_[i + 1] : entries_;
      std::ranges::move(here(starts_[i], end - starts_[i], [](std::size_t) {}),
                        all.begin() + static_cast<std::ptrdiff_t>(starts_[i] - first));
    }
    return all;
  }
  const std::vector<std::size_t>& starts() const { return starts_; }

 private:
  const std::size_t alone_, entries_;
  std::vector<std::size_t> starts_;
};

/// To the last bit.
void expect_same(const SweepEntry& found, const SweepEntry& expected) {
  EXPECT_EQ(found.error, expected.error);
  EXPECT_EQ(found.energy, expected.energy);
  EXPECT_EQ(found.penetration, expected.penetration);
  EXPECT_EQ(found.complementarity, expected.complementarity);
  EXPECT_EQ(found.iterations, expected.iterations);
  ASSERT_EQ(found.contact.size(), expected.contact.size());
  for (std::size_t i = 0; i < found.contact.size(); ++i)
    EXPECT_EQ(found.contact[i].pressure, expected.contact[i].pressure);
  ASSERT_EQ(found.parts.size(), expected.parts.size());
  for (std::size_t i = 0; i < found.parts.size(); ++i)
    EXPECT_EQ(found.parts[i].force, expected.parts[i].force);
}

TEST(Sweep, HelpersFindWhatOneFindsAlone) {
  for (const Scheme scheme : {Scheme::conforming, Scheme::nonconforming}) {
    Problem problem = problems::paper(scheme, 6);
    problem.load_key = "own";
    std::vector<Variation> sweep;
    for (int i = 0; i < 24; ++i) {
      Problem other = problem;
      // Three of each shape, of which two follow each other, and a material in between.
      const double height = 0.01 * i, bend = i / 2 % 3;
      std::get<Contact>(other.boundary["bottom"]).gap =
          problems::function([=](const Point& x) { return height + bend * x.x() * x.x(); });
      if (i >= 18) other.body = VectorField(-3 - i / 21);
      sweep.push_back(data_of(other, i < 18 ? "own" : "other " + std::to_string(i / 21)));
      if (i == 8 || i == 9) {
        sweep.back().material = std::make_shared<const Material>(MembraneStiffness::isotropic(2));
        sweep.back().material_key = "2";
      }
    }
    for (const Method& method : {Method(ActiveSet{}), Method(PaperUzawa{0.1, 1})})
      for (const std::size_t alone : {1, 4, 20}) {
        Settings settings{method, {}};
        const Solution expected = solve_sweep(problem, sweep, settings);
        Backwards backwards(alone, sweep.size());
        settings.helpers = &backwards;
        const Solution found = solve_sweep(problem, sweep, settings);
        EXPECT_FALSE(backwards.starts().empty());
        if (scheme == Scheme::nonconforming && alone == 1 && std::holds_alternative<ActiveSet>(method)) {
          EXPECT_EQ(backwards.starts(), (std::vector<std::size_t>{8, 10, 18, 21}));
        }
        ASSERT_EQ(found.sweep.size(), sweep.size());
        for (std::size_t i = 0; i < sweep.size(); ++i) expect_same(found.sweep[i], expected.sweep[i]);
        // As a worker solves it who has nothing else of it.
        const std::size_t last = backwards.starts().back();
        settings = {method, {}};
        settings.entries_alone = true;
        const std::vector<Variation> rest(sweep.begin() + static_cast<std::ptrdiff_t>(last), sweep.end());
        const Solution piece = solve_sweep(problem, rest, settings);
        EXPECT_TRUE(piece.contact.empty());
        for (std::size_t i = 0; i < rest.size(); ++i) expect_same(piece.sweep[i], expected.sweep[last + i]);
      }
  }
}

TEST(Sweep, CanBeCancelledBetweenEntries) {
  const Problem problem = problems::paper(Scheme::nonconforming, 6);
  const std::vector<Variation> sweep(5, data_of(problem, "loads"));
  StopsAfter stopper(3);
  EXPECT_THROW(solve_sweep(problem, sweep, {}, stopper), Cancelled);
  EXPECT_EQ(stopper.done(), 3u);
}

TEST(Sweep, TheTimeLimitIsForTheWhole) {
  const Problem problem = problems::paper(Scheme::nonconforming, 24);
  // To look through the entries takes a part of it.
  const std::vector<Variation> sweep(3000, data_of(problem, ""));
  const Solution solution = solve_sweep(problem, sweep, {ActiveSet{}, sanitized ? 3 : 0.3});
  EXPECT_EQ(solution.sweep.size(), sweep.size());
  EXPECT_EQ(solution.sweep.front().error, "");
  EXPECT_NE(solution.sweep.back().error.find("the time limit of "), std::string::npos);
}

/// Of thousands of entries, whose discretizations alone would take a hundred times as long as the limit.
TEST(Sweep, EntriesBehindTheTimeLimitAreNotBegun) {
  const Problem problem = problems::hanging_block(Scheme::conforming, sanitized ? 20 : 60);
  std::vector<Variation> sweep(2000, data_of(problem, ""));
  const auto begin = std::chrono::steady_clock::now();
  const Solution solution = solve_sweep(problem, sweep, {ActiveSet{}, 0.3});
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  EXPECT_NE(solution.sweep.back().error.find("the time limit of "), std::string::npos);
  EXPECT_LT(taken.count(), 3);
}

}  // namespace
}  // namespace signorini::sweep_test
