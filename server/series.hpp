#pragma once

#include <string>
#include <vector>

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

  /// The problem itself has the number 0.
  void add_entry(std::size_t number, const Solution& solution);

  /// Writes what makes the files a series. Throws BadInput.
  void finish();

 private:
  void add(double time, const std::string& name, const Solution& solution);

  const std::string directory_;
  std::vector<api::SeriesFile> files_;
};

}  // namespace signorini::server
