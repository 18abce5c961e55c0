#include "api/problem/batch_json.hpp"

#include <algorithm>

#include "api/document/json_document.hpp"
#include "api/document/json_slices.hpp"
#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

using nlohmann::json;

const std::string problems_pointer = "/problems";

/// The batch without its problems: a document as small as its other members.
json without_problems(std::string_view text, std::string_view& problems) {
  json document = json::object();
  for (const auto& [name, slice] : member_slices(text)) {
    if (document.contains(name))
      throw MalformedJson("the member " + in_quotes(name) + " is there twice; give it once");
    const bool is_known = name == "title" || name == "tags";
    document[name] = is_known ? parse_json(slice) : json();
    if (name == "problems") problems = slice;
  }
  return document;
}

std::vector<std::string_view> problems_of(std::string_view list, const Value& batch) {
  std::vector<std::string_view> problems = element_slices(list);
  const Value here(batch.json(), problems_pointer, batch.faults());
  if (list.empty()) {
    here.fault("is missing; it gives the problems, an array");
  } else if (problems.empty()) {
    here.fault("must be an array of at least one problem");
  } else if (problems.size() > limits::batch_problems) {
    here.fault("must have at most " + std::to_string(limits::batch_problems) + " entries; it has " +
               std::to_string(problems.size()) + ": split the batch");
    problems.clear();
  }
  return problems;
}

}  // namespace

Batch parse_batch(std::string_view text, const ReadProblem& read) {
  require_json(text);
  Faults faults;
  Batch batch;
  std::string_view list;
  const bool is_object = text[text.find_first_not_of(" \t\r\n")] == '{';
  const json document = is_object ? without_problems(text, list) : json();
  const Value value(document, "", faults);
  const auto object = value.object();
  faults.throw_if_any();
  object->allow({"title", "tags", "problems"}, "a batch");
  if (const auto title = object->find("title")) batch.title = read_title(*title);
  if (const auto tags = object->find("tags")) batch.tags = read_tags(*tags);
  const std::vector<std::string_view> problems = problems_of(list, value);
  for (std::size_t i = 0; i < problems.size() && !faults.is_full(); ++i) {
    const std::string pointer = pointer_to(problems_pointer, i);
    try {
      read(batch, problems[i], pointer);
    } catch (const InvalidProblem& invalid) {
      for (const Fault& fault : invalid.faults()) faults.add(pointer + fault.where, fault.detail);
    } catch (const MalformedJson& malformed) {
      throw MalformedJson("in the problem at " + in_quotes(pointer) + ": " + malformed.what());
    }
  }
  faults.throw_if_any();
  return batch;
}

void add_tags(const std::vector<std::string>& of_batch, std::vector<std::string>& tags) {
  for (const std::string& tag : of_batch)
    if (std::ranges::find(tags, tag) == tags.end()) tags.push_back(tag);
  if (tags.size() > limits::tags)
    throw InvalidProblem(std::vector<Fault>{{"/tags", "has " + std::to_string(tags.size()) +
                                                          " tags with those of the batch; it may have " +
                                                          std::to_string(limits::tags)}});
}

}  // namespace signorini::api
