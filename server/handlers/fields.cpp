#include "server/handlers/fields.hpp"

#include "server/http/query.hpp"

namespace signorini::server {
namespace {

/// What `use` returns, its complaint about the fields turned into 400.
template <typename Use>
auto with_fields(const Use& use) {
  try {
    return use();
  } catch (const InvalidProblem& invalid) {
    throw bad_parameter("fields", invalid.faults().front().detail);
  }
}

}  // namespace

api::ResultFields fields_of(const Request& request) {
  return with_fields(
      [&] { return api::ResultFields::parse(parameter(request.query, "fields").value_or("")); });
}

void require_available(const api::ResultFields& fields, int components) {
  with_fields([&] { fields.require_available(components); });
}

bool picks_summary_alone(const Query& query) {
  return parameter(query, "fields") == "summary";
}

}  // namespace signorini::server
