#pragma once

#include <vector>

#include "mesh/mesh.hpp"
#include "problem/problem.hpp"

namespace signorini {

class Progress;

/// What it takes to ask for the data of all edges, as steps_of() counts it.
double steps_on_boundary(const Problem& problem, const Mesh& mesh);

/// validate() of a sweep that may be long. It ends behind the variation with which the check has taken so
/// many steps, as steps_of() counts them. Throws what the progress throws, if there is one.
std::vector<Fault> faults_of_sweep(const Problem& problem, const std::vector<Variation>& sweep,
                                   double most_steps, Progress* progress);

struct DataCheck {
  std::vector<Fault> faults;
  bool is_complete = true;
};

/// The faults of the data of a problem, and of the variations of its sweep, in the points of its mesh that
/// the discrete problem asks. Of its fields together, and of the sweep, only so much is looked at as takes
/// `most_steps`; then the check is not complete. Throws what the progress throws, if there is one.
DataCheck check_data(const Problem& problem, const std::vector<Variation>& sweep, const Mesh& mesh,
                     double most_steps, Progress* progress);

/// The same of all of the problem's own data. Throws InvalidProblem if there is a fault. A variation is
/// looked at when it is solved, and has its error by itself.
void require_sound_data(const Problem& problem, const Mesh& mesh, Progress& progress);

}  // namespace signorini
