#include "api/problem/problem_json.hpp"

#include <algorithm>

#include "api/document/json_document.hpp"
#include "api/limits.hpp"
#include "api/problem/operator_key.hpp"
#include "api/problem/problem_members.hpp"
#include "run/data_check.hpp"
#include "solve.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

/// What the check of a sweep's entries may take, about 10 ms; the solve checks the others.
constexpr double most_steps_of_sweep = 1e6;

/// A mesh that refines itself for a quantity needs one of that name.
void check_goal(const Value& mesh, const Problem& problem) {
  const std::optional<Adaptive>& adaptive = problem.mesh.adaptive;
  if (!adaptive || adaptive->quantity.empty() ||
      std::ranges::find(problem.quantities, adaptive->quantity, &Quantity::name) != problem.quantities.end())
    return;
  std::vector<std::string_view> known;
  for (const Quantity& quantity : problem.quantities) known.push_back(quantity.name);
  mesh.faults().add(mesh.pointer() + "/adaptive/quantity",
                    "there is no quantity " + in_quotes(adaptive->quantity) +
                        suggestion(adaptive->quantity, known) +
                        (known.empty() ? ": name one in quantities" : "; known are: " + list_of(known)));
}

Problem read_problem(const Object& document) {
  Problem problem;
  Model kind = Model::membrane;
  if (const auto model = document.require("model", "what is solved: " + list_of(only_names(model_names))))
    kind = model->one_of(model_names).value_or(kind);
  if (const auto domain = document.require("domain", "the shape of the body"))
    problem.domain = read_domain(*domain);
  const bool brings_mesh = std::holds_alternative<MeshData>(problem.domain);
  const auto mesh =
      brings_mesh ? document.find("mesh") : document.require("mesh", "the fineness, as size or as divisions");
  if (mesh) problem.mesh = read_mesh(*mesh, problem.domain);
  if (const auto material = document.require("material", "what the body is made of"))
    problem.material = read_material(*material, kind);
  if (const auto load = document.find("load")) problem.body = read_load(*load, kind);
  if (const auto boundary = document.require("boundary", "the conditions on the parts of the boundary"))
    problem.boundary = read_boundary(*boundary, kind, problem.domain);
  if (const auto scheme = document.require("scheme", "the spaces: " + list_of(only_names(scheme_names))))
    problem.scheme = scheme->one_of(scheme_names).value_or(problem.scheme);
  if (const auto quantities = document.find("quantities"))
    problem.quantities = read_quantities(*quantities, kind, problem);
  if (mesh) check_goal(*mesh, problem);
  return problem;
}

Request read_request(const Value& value) {
  Request request;
  const auto document = value.object();
  if (!document) return request;
  document->allow({"title", "tags", "model", "domain", "mesh", "material", "load", "boundary", "scheme",
                   "quantities", "solver", "sweep", "study"},
                  "a problem");
  if (const auto title = document->find("title")) request.title = read_title(*title);
  if (const auto tags = document->find("tags")) request.tags = read_tags(*tags);
  request.problem = read_problem(*document);
  if (const auto solver = document->find("solver")) request.settings = read_settings(*solver);
  if (const auto sweep = document->find("sweep"))
    request.sweep = read_sweep(*sweep, *document, request.problem);
  if (const auto study = document->find("study")) {
    if (document->find("sweep")) study->fault("cannot stand beside a sweep: post them one by one");
    request.study = read_study(*study, *document, request.problem);
  }
  return request;
}

/// A document of megabytes takes several times as much, and is gone when it is read.
Request read_document(std::string_view text, Observer* observer) {
  const json document = parse_json(text, observer);
  Faults faults;
  Request request = read_request(Value(document, "", faults));
  faults.throw_if_any();
  request.problem.operator_key = operator_key(document);
  request.problem.load_key = load_key(json::object());
  return request;
}

}  // namespace

Request parse_request(std::string_view text, Observer* observer) {
  Request request = read_document(text, observer);
  if (observer && !observer->keep_going()) throw Cancelled();
  if (auto found = validate(request.problem, request.settings); !found.empty())
    throw InvalidProblem(std::move(found));
  if (auto found = faults_of_sweep(request.problem, request.sweep, most_steps_of_sweep, nullptr);
      !found.empty())
    throw InvalidProblem(std::move(found));
  if (!request.study) return request;
  if (auto found = validate(request.problem, *request.study, request.settings); !found.empty())
    throw InvalidProblem(std::move(found));
  return request;
}

}  // namespace signorini::api
