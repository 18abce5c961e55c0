// Problems whose numbers are near the ends of the range of double precision: each ends with a result of which
// every number can be written, or with a reason.
#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "../problems/no_cache.hpp"
#include "api/problem/problem_json.hpp"
#include "api/result/result_document.hpp"
#include "api/result/vtu.hpp"
#include "solve.hpp"
#include "written_by.hpp"

namespace signorini::api::extreme_bodies_test {
namespace {

using nlohmann::json;

Solution solved(const std::string& body) {
  NoCache none;
  Observer nobody;
  const Request request = parse_request(body);
  return solve(request.problem, request.sweep, request.settings, nobody, none);
}

void expect_can_be_written(const Solution& solution, bool is_elastic) {
  const auto fields = ResultFields::parse(
      std::string("summary,mesh,displacement,stress,contact,history,sweep,quantities,error_squares,levels") +
      (is_elastic ? ",principal,von_mises" : ""));
  for (const Format format : {Format::json, Format::cbor})
    EXPECT_NO_THROW(text_of(
        [&](DocumentWriter& out) {
          write_result(out, {"", "succeeded", "{}"}, solution, fields);
        },
        format));
  EXPECT_NO_THROW(written_by([&](const Sink& sink) { return write_vtu(solution, sink); }));
}

/// Found from outside: they ended with an internal error, as a job that broke every list of jobs, or not at
/// all.
TEST(ExtremeBodies, LeaveTheRangeAndSaySo) {
  for (const json& body : json::parse(std::ifstream(EXTREME_BODIES))) {
    SCOPED_TRACE(body.dump());
    try {
      solved(body.dump());
      ADD_FAILURE() << "there is a solution";
    } catch (const SolveError& failure) {
      EXPECT_NE(std::string(failure.what()).find("leave the range of double precision"), std::string::npos)
          << failure.what();
    }
  }
}

TEST(ExtremeBodies, EndWithNumbersOrAReason) {
  std::mt19937 random(2026);
  const auto power = [&](double most) {
    return std::pow(10., std::uniform_real_distribution<>(-most, most)(random));
  };
  const auto any_of = [&](auto... items) {
    const std::array all{items...};
    return all[std::uniform_int_distribution<std::size_t>(0, all.size() - 1)(random)];
  };
  int solutions = 0;
  for (int i = 0; i < 400; ++i) {
    const double most = any_of(30., 60., 100.), length = power(most), load = power(2 * most);
    const bool is_elastic = any_of(true, false);
    json body{{"model", is_elastic ? "elasticity" : "membrane"},
              {"scheme", any_of("conforming", "nonconforming")},
              {"domain", {{"type", "rectangle"}, {"size", {length, length}}}},
              {"mesh", {{"divisions", {3, 2}}, {"pattern", any_of("crossed", "right")}}},
              {"boundary",
               {{"left", {{"type", "fixed"}}},
                {"bottom", {{"type", "contact"}, {"gap", any_of(0., length, 1e-3 * length, power(most))}}}}},
              {"solver", {{"method", any_of("active_set", "uzawa")}}}};
    const double modulus = power(2 * most);
    if (is_elastic) {
      body["material"] = {{"young", modulus}, {"poisson", any_of(0., 0.3, 0.4999)}};
      body["load"]["body"] = {any_of(0., load), -load};
    } else {
      body["material"] = {{"stiffness", modulus}};
      body["load"]["body"] = -load;
    }
    if (any_of(true, false))
      body["quantities"] = {{{"name", "grip"}, {"type", "pressure_force"}, {"part", "bottom"}}};
    SCOPED_TRACE(body.dump());
    try {
      expect_can_be_written(solved(body.dump()), is_elastic);
      ++solutions;
    } catch (const SolveError& failure) {
      EXPECT_GT(std::string(failure.what()).size(), 20u);
    } catch (const InvalidProblem& invalid) {
      EXPECT_FALSE(invalid.faults().empty());
    }
  }
  EXPECT_GT(solutions, 100);
}

}  // namespace
}  // namespace signorini::api::extreme_bodies_test
