#include "server/solve_command.hpp"

#include "api/picture/picture.hpp"
#include "api/result/csv.hpp"
#include "api/result/result_document.hpp"
#include "api/result/result_table.hpp"
#include "api/result/vtu.hpp"
#include "server/local_solve.hpp"
#include "server/terminal.hpp"

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
  enum class File { document, table, vtu, picture, contact_csv, history_csv, quantities_csv };

  File file = File::document;
  api::ResultFields fields;
  api::Format document = api::Format::json;
  api::Picture picture;
};

Form::File file_asked_for(const SolveConfig& config) {
  using File = Form::File;
  if (config.format == "vtu") return File::vtu;
  if (config.format == "svg") return File::picture;
  if (config.format == "csv" && config.field == "history") return File::history_csv;
  if (config.format == "csv") return config.field == "quantities" ? File::quantities_csv : File::contact_csv;
  const bool is_read = config.format.empty() && config.fields.empty() && writes_to_terminal();
  return config.format == "table" || is_read ? File::table : File::document;
}

/// Throws BadInput for flags that do not go together.
void require_sense(const SolveConfig& config, Form::File file) {
  const bool is_picture = file == Form::File::picture, is_csv = config.format == "csv";
  if (file != Form::File::document && !config.fields.empty())
    throw bad_flag("fields", "a file of the format " + config.format + " has no members; leave the flag out");
  if (config.deformed && !is_picture) throw bad_flag("deformed", "is for pictures; add --format svg");
  if (!config.field.empty() && !is_picture && !is_csv)
    throw bad_flag("field", "is for pictures and tables; add --format svg or csv");
  if (is_csv && !config.field.empty() && config.field != "contact" && config.field != "history" &&
      config.field != "quantities")
    throw bad_flag("field", "must be contact, history or quantities in the format csv");
  if (config.deformed && !(*config.deformed >= 0 && *config.deformed <= api::Picture::most_deformed))
    throw bad_flag("deformed", "must be a number from 0 to 1e15");
}

Form form_of(const SolveConfig& config) {
  Form form;
  form.file = file_asked_for(config);
  require_sense(config, form.file);
  if (config.format == "cbor") form.document = api::Format::cbor;
  return with_flags([&] {
    form.fields = api::ResultFields::parse(config.fields);
    if (form.file == Form::File::picture)
      form.picture = {api::Picture::field_named(config.field), config.deformed};
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

bool write_document(const std::string& problem, const Ending& ending, const Form& form,
                    const api::Sink& sink) {
  const std::string error = error_to_json(ending.error);
  const api::ResultHead head{{}, name(ending.status), problem, error};
  return api::write_document(form.document, sink, [&](api::DocumentWriter& out) {
    api::write_result(out, head, *ending.solution, form.fields);
  });
}

bool write(const std::string& problem, const std::string& title, const Ending& ending, const Form& form,
           const api::Sink& sink) {
  const Solution& solution = *ending.solution;
  switch (form.file) {
    case Form::File::document:
      break;
    case Form::File::table:
      return api::write_result_table(title, solution, sink);
    case Form::File::vtu:
      return api::write_vtu(solution, sink);
    case Form::File::contact_csv:
      return api::write_contact_csv(solution.contact, sink);
    case Form::File::history_csv:
      return api::write_history_csv(solution.history, sink);
    case Form::File::quantities_csv:
      return api::write_quantities_csv(solution.summary.quantities, sink);
    case Form::File::picture:
      with_flags([&] { form.picture.require_available(solution); });
      return api::write_picture(solution, form.picture, sink);
  }
  return write_document(problem, ending, form, sink);
}

}  // namespace

int run_solve(const SolveConfig& config) {
  return run_locally([&] {
    Form form = form_of(config);
    const std::string text = read_input(config.file);
    api::Request request = parse_input(text);
    request.settings.factorization = config.factorization;
    require_available(form, request);
    form.picture.contacts = api::Picture::contacts_of(request.problem);
    std::optional<Series> series;
    if (!config.series.empty()) series.emplace(config.series);
    const auto write_result = [&](const Ending& ending, const api::Sink& sink) {
      return write(text, request.title, ending, form, sink);
    };
    return solve_and_write(request, write_result, series ? &*series : nullptr);
  });
}

}  // namespace signorini::server
