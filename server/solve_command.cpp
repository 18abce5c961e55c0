#include "server/solve_command.hpp"

#include "api/result_document.hpp"
#include "api/vtu.hpp"
#include "server/local_solve.hpp"

namespace signorini::server {
namespace {

BadInput bad_fields(const std::string& detail) {
  return {{"bad-flag", "Bad flag", "--fields: " + detail}};
}

/// The result as it is asked for.
struct Form {
  api::ResultFields fields;
  bool vtu = false;
  api::Format document = api::Format::json;  ///< if it is no .vtu file
};

Form form_of(const SolveConfig& config) {
  const bool vtu = config.format == "vtu";
  if (vtu && !config.fields.empty()) throw bad_fields("a .vtu file has all its fields; leave the flag out");
  try {
    return {api::ResultFields::parse(config.fields), vtu,
            config.format == "cbor" ? api::Format::cbor : api::Format::json};
  } catch (const InvalidProblem& invalid) {
    throw bad_fields(invalid.faults().front().detail);
  }
}

/// Before the solve, which may take long.
void require_available(const api::ResultFields& fields, const api::Request& request) {
  try {
    fields.require_available(components(request.problem.material));
  } catch (const InvalidProblem& invalid) {
    throw bad_fields(invalid.faults().front().detail);
  }
}

bool write(const std::string& problem, const Ending& ending, const Form& form, const api::Sink& sink) {
  if (form.vtu) return api::write_vtu(*ending.solution, sink);
  const api::ResultHead head{{}, name(ending.status), problem};
  return api::write_document(form.document, sink, [&](api::DocumentWriter& out) {
    api::write_result(out, head, *ending.solution, form.fields);
  });
}

}  // namespace

int run_solve(const SolveConfig& config) {
  return run_locally([&] {
    const Form form = form_of(config);
    const std::string text = read_input(config.file);
    const api::Request request = parse_input(text);
    require_available(form.fields, request);
    return solve_and_write(request, [&](const Ending& ending, const api::Sink& sink) {
      return write(text, ending, form, sink);
    });
  });
}

}  // namespace signorini::server
