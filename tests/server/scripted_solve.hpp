#pragma once

#include <string>

#include "server/jobs/run.hpp"

namespace signorini::server {

/// A valid problem document with this title.
std::string problem_titled(const std::string& title);

/// Stands in for the solver; the title of the problem says what happens:
/// `instant` converges, `slow` iterates until it is cancelled, `short` iterates for 0.2 s, `busy` 20 000
/// times at once, `large` has a result of some megabytes, `huge` of more than ten, `touches` one with a mesh
/// and a contact part, `elastic` one of an elastic body, `diverges` has a result and did not converge,
/// `refines` reports levels until it is cancelled and then has the result of the last one, and `throws`, `no
/// memory`, `no solution`, `not finite` throw what the solver would.
Solution scripted_solve(const api::Request& request, Observer& observer);

}  // namespace signorini::server
