// The solver by itself: this program sees neither JSON nor HTTP nor logging, and links nothing but the
// solver. It fails to compile if a header of the solver needs them.
#include "solve.hpp"

#if defined(INCLUDE_NLOHMANN_JSON_HPP_) || defined(CPPHTTPLIB_HTTPLIB_H) || defined(SPDLOG_H)
#error "the solver must not know JSON, HTTP or logging"
#endif

int main() {
  signorini::Problem problem;
  problem.mesh.fineness = signorini::Divisions{4, 4};
  problem.body = signorini::Field(-1);
  problem.boundary = {{"left", signorini::Fixed{}}, {"bottom", signorini::Contact{0.01}}};
  return signorini::solve(problem).summary.outcome == signorini::Outcome::converged ? 0 : 1;
}
