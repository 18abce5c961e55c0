#pragma once

#include <string>
#include <vector>

#include "api/problem/problem_json.hpp"
#include "api/result/pvd.hpp"
#include "progress/observer.hpp"
#include "result/solution.hpp"

namespace signorini::server {

/// Solutions as files for ParaView in a directory, `series.pvd` and a `.vtu` each: the levels of a mesh that
/// refines itself, or the entries of a sweep behind the problem itself.
class Series {
 public:
  /// Makes the directory if there is none. Throws BadInput.
  explicit Series(std::string directory);

  void add_level(const Level& level, const Solution& solution);

  /// The problem itself and each entry of its sweep, which is solved once more for its fields; one that has
  /// no solution is left out. Throws Cancelled.
  void add_sweep(const api::Request& request, const Solution& solution, Observer& observer);

  /// Writes what makes the files a series. Throws BadInput.
  void finish() const;

 private:
  void add(double time, const std::string& name, const Solution& solution);

  const std::string directory_;
  std::vector<api::SeriesFile> files_;
};

}  // namespace signorini::server
