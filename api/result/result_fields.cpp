#include <algorithm>

#include "api/names.hpp"
#include "api/result/result_document.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

/// Every member that may be picked; `summary` is there in any case and sets nothing.
const Names<bool ResultFields::*> field_names{{"summary", nullptr},
                                              {"problem", &ResultFields::problem},
                                              {"mesh", &ResultFields::mesh},
                                              {"displacement", &ResultFields::displacement},
                                              {"stress", &ResultFields::stress},
                                              {"contact", &ResultFields::contact},
                                              {"history", &ResultFields::history},
                                              {"sweep", &ResultFields::sweep},
                                              {"study", &ResultFields::study},
                                              {"quantities", &ResultFields::quantities},
                                              {"principal", &ResultFields::principal},
                                              {"von_mises", &ResultFields::von_mises},
                                              {"error_squares", &ResultFields::error_squares},
                                              {"levels", &ResultFields::levels}};

void pick(ResultFields& fields, std::string_view name) {
  const auto entry = std::ranges::find(field_names, name, &Named<bool ResultFields::*>::name);
  if (entry == field_names.end()) {
    const auto known = only_names(field_names);
    throw InvalidProblem({{"/fields", "a result has no member " + in_quotes(name) + suggestion(name, known) +
                                          "; known are: " + list_of(known)}});
  }
  if (entry->value != nullptr) fields.*entry->value = true;
}

}  // namespace

ResultFields ResultFields::parse(std::string_view list) {
  if (list.empty()) return {};
  ResultFields fields{false, false, false, false, false, false, false, false, false};
  for (std::size_t start = 0; start <= list.size();) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    pick(fields, list.substr(start, comma - start));
    start = comma + 1;
  }
  return fields;
}

void ResultFields::require_available(int components) const {
  if (components > 1) return;
  const auto refuse = [](std::string_view name) {
    throw InvalidProblem(
        {{"/fields", "a membrane has no " + in_quotes(name) +
                         ": its stress is a vector; leave it out and pick " + in_quotes("stress")}});
  };
  if (principal) refuse("principal");
  if (von_mises) refuse("von_mises");
}

}  // namespace signorini::api
