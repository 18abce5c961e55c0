#include "server/inf_sup_command.hpp"

#include <cstdio>
#include <optional>

#include "api/document/document_writer.hpp"
#include "api/names.hpp"
#include "api/result/result_members.hpp"
#include "run/inf_sup_check.hpp"
#include "server/local_solve.hpp"

namespace signorini::server {
namespace {

bool write_table(const InfSup& found, const api::Sink& sink) {
  char constant[32];
  std::snprintf(constant, sizeof constant, "%.6g", found.constant);
  return sink("inf-sup constant  " + std::string(constant) + "\nscheme            " +
              std::string(api::name_in(api::scheme_names, found.scheme)) + "\ntriangles         " +
              std::to_string(found.triangles) + "\nstress unknowns   " +
              std::to_string(found.unknowns.stress) + "\n");
}

bool write(const InfSup& found, const std::string& format, const api::Sink& sink) {
  if (format == "table") return write_table(found, sink);
  return api::write_document(api::Format::json, sink, [&](api::DocumentWriter& out) {
    out.begin_object()
        .member("inf_sup", found.constant)
        .member("scheme", api::name_in(api::scheme_names, found.scheme))
        .member("triangles", found.triangles);
    api::write_unknowns(out.key("unknowns"), found.unknowns);
    out.end_object();
  });
}

}  // namespace

int run_inf_sup(const InfSupConfig& config) {
  return run_locally([&] {
    const api::Request request = parse_input(read_input(config.file));
    std::optional<InfSup> found;
    return find_and_write(
        estimate(request.problem).triangles,
        [&](Observer& observer) { found = inf_sup_of(request.problem, request.settings, observer); },
        [&](const api::Sink& sink) { return write(*found, config.format, sink); });
  });
}

}  // namespace signorini::server
