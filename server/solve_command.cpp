#include "server/solve_command.hpp"

#include "api/picture/picture.hpp"
#include "api/result_document.hpp"
#include "api/vtu.hpp"
#include "server/local_solve.hpp"

namespace signorini::server {
namespace {

BadInput bad_flag(const std::string& flag, const std::string& detail) {
  return {{"bad-flag", "Bad flag", "--" + flag + ": " + detail}};
}

/// What `use` returns; a complaint about `/fields` and the like is one about the flag of that name.
template <typename Use>
auto with_flags(const Use& use) {
  try {
    return use();
  } catch (const InvalidProblem& invalid) {
    const Fault& fault = invalid.faults().front();
    throw bad_flag(fault.where.substr(1), fault.detail);
  }
}

/// The result as it is asked for.
struct Form {
  enum class File { document, vtu, picture };

  File file = File::document;
  api::ResultFields fields;
  api::Format document = api::Format::json;
  api::Picture picture;
};

Form form_of(const SolveConfig& config) {
  Form form;
  if (config.format == "vtu") form.file = Form::File::vtu;
  if (config.format == "svg") form.file = Form::File::picture;
  if (config.format == "cbor") form.document = api::Format::cbor;
  if (form.file != Form::File::document && !config.fields.empty())
    throw bad_flag("fields", "a file of the format " + config.format + " has no members; leave the flag out");
  if (form.file != Form::File::picture && (!config.picture.empty() || config.deformed))
    throw bad_flag(config.picture.empty() ? "deformed" : "field", "is for pictures; add --format svg");
  if (config.deformed && !(*config.deformed >= 0 && *config.deformed <= api::Picture::most_deformed))
    throw bad_flag("deformed", "must be a number from 0 to 1e15");
  return with_flags([&] {
    form.fields = api::ResultFields::parse(config.fields);
    form.picture = {api::Picture::field_named(config.picture), config.deformed};
    return form;
  });
}

/// Before the solve, which may take long.
void require_available(const Form& form, const api::Request& request) {
  with_flags([&] {
    form.fields.require_available(components(request.problem.material));
    if (form.file == Form::File::picture)
      form.picture.require_available(components(request.problem.material));
  });
}

bool write(const std::string& problem, const Ending& ending, const Form& form, const api::Sink& sink) {
  if (form.file == Form::File::vtu) return api::write_vtu(*ending.solution, sink);
  if (form.file == Form::File::picture) {
    with_flags([&] { form.picture.require_available(*ending.solution); });
    return api::write_picture(*ending.solution, form.picture, sink);
  }
  const std::string error = error_to_json(ending.error);
  const api::ResultHead head{{}, name(ending.status), problem, error};
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
    require_available(form, request);
    return solve_and_write(request, [&](const Ending& ending, const api::Sink& sink) {
      return write(text, ending, form, sink);
    });
  });
}

}  // namespace signorini::server
