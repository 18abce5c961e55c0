#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "problems/elasticity.hpp"
#include "solve.hpp"

namespace signorini {

/// A solved problem with what its certificate is made from.
struct SolvedProblem {
  SolvedProblem(const Problem& posed, const Solution& solved)
      : problem(posed), solution(solved), discretization(problem, *solution.mesh) {
    clearance.resize(discretization.clearance.rows.size());
    Eigen::Index next = 0;
    for (const ContactPart& part : solution.contact)
      for (const double own : part.clearance) clearance[next++] = own;
  }

  /// By the clearance alone, as if all other traces were 0.
  AdmissibleDisplacement displacement() const {
    Eigen::VectorXd coupling = Eigen::VectorXd::Zero(discretization.traces.unknowns());
    for (const ClearanceRow& row : discretization.clearance.rows)
      if (row.unknown >= 0)
        coupling[discretization.traces.free_unknowns() + row.unknown] =
            clearance[&row - discretization.clearance.rows.data()];
    return {discretization, solution, coupling, progress};
  }

  Problem problem;
  Solution solution;
  Discretization discretization;
  Eigen::VectorXd clearance;
  Observer observer;
  mutable Progress progress{observer, std::nullopt};
};

/// A block pressed by a punch, bent besides, on a foundation that it leaves at one side. Its loads have
/// couples on triangles and edges.
inline Problem punch(Scheme scheme) {
  Problem problem;
  problem.mesh = {Divisions{8, 6}, Pattern::crossed};
  problem.scheme = scheme;
  problem.material = YoungPoisson{Field(2), Field(0.35), Plane::strain};
  problem.boundary = {{"top", Fixed{VectorField(0.02, -0.05)}},
                      {"bottom", Contact{problems::formula("0.2 * (x - 0.3)^2")}},
                      {"left", Traction{VectorField(problems::formula("0.03 + 0.1 * y^2"), Field(-0.02))}}};
  problem.body = VectorField(problems::formula("0.1 + y"), problems::formula("-0.2 - x * y"));
  return problem;
}

}  // namespace signorini
