#include "api/result/pvd.hpp"

#include "api/wording.hpp"

namespace signorini::api {

bool write_pvd(const std::vector<SeriesFile>& files, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    out.put("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n  <Collection>\n");
    for (const SeriesFile& file : files)
      out.put("    <DataSet timestep=\"" + shortest(file.time) + "\" part=\"0\" file=\"" + file.name +
              "\"/>\n");
    out.put("  </Collection>\n</VTKFile>\n");
  });
}

}  // namespace signorini::api
