#pragma once

#include <string>
#include <vector>

#include "api/document/piece_writer.hpp"

namespace signorini::api {

/// A file of a series, and the time at which it stands there.
struct SeriesFile {
  double time = 0;
  std::string name;  ///< beside the series
};

/// Writes a ParaView collection (.pvd) of .vtu files. Returns false if the sink ended it.
bool write_pvd(const std::vector<SeriesFile>& files, const Sink& sink);

}  // namespace signorini::api
