#include "api/problem/reader.hpp"

#include <algorithm>
#include <cmath>

namespace signorini::api {
namespace {

using nlohmann::json;

std::string found(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case json::value_t::string:
      return "the string " + in_quotes(value.get_ref<const std::string&>());
    case json::value_t::array:
      return "an array of length " + std::to_string(value.size());
    case json::value_t::object:
      return "an object";
    default:
      return shortest(value.get<double>());
  }
}

}  // namespace

std::size_t characters(const std::string& text) {
  const auto starts_character = [](char c) { return (c & '\xC0') != '\x80'; };
  return static_cast<std::size_t>(std::ranges::count_if(text, starts_character));
}

void Faults::add(std::string pointer, std::string detail) {
  if (faults_.size() < most) {
    faults_.push_back({std::move(pointer), std::move(detail)});
  } else {
    ++unlisted_;
  }
}

void Faults::add(const InvalidProblem& invalid) {
  for (const Fault& fault : invalid.faults()) add(fault.where, fault.detail);
}

bool Faults::has_any_at(std::string_view pointer) const {
  return std::ranges::any_of(faults_, [&](const Fault& fault) { return fault.where.starts_with(pointer); });
}

void Faults::throw_if_any() const {
  if (faults_.empty()) return;
  std::vector<Fault> faults = faults_;
  if (unlisted_ > 0)
    faults.push_back({"", "at least " + std::to_string(unlisted_) + " more faults are not listed"});
  throw InvalidProblem(std::move(faults));
}

void Value::unexpected(std::string_view expected) const {
  fault("must be " + std::string(expected) + "; not " + found(*json_));
}

std::optional<double> Value::number(std::string_view expected,
                                    const std::function<bool(double)>& meets) const {
  if (json_->is_number() && meets(json_->get<double>())) return json_->get<double>();
  unexpected(expected);
  return std::nullopt;
}

std::optional<double> Value::number() const {
  return number("a number", [](double) { return true; });
}

std::optional<double> Value::positive() const {
  return number("a positive number", [](double value) { return value > 0; });
}

std::optional<int> Value::integer(int least, int most) const {
  const auto expected = "a whole number from " + std::to_string(least) + " to " + std::to_string(most);
  const auto whole = [&](double value) {
    return value == std::floor(value) && value >= least && value <= most;
  };
  const auto value = number(expected, whole);
  return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::optional<std::string> Value::text(std::size_t most) const {
  const std::string expected = "a string of at most " + std::to_string(most) + " characters";
  const auto* text = json_->get_ptr<const std::string*>();
  if (text == nullptr) {
    unexpected(expected);
  } else if (const std::size_t length = characters(*text); length > most) {
    fault("must be " + expected + "; it has " + std::to_string(length));
  } else {
    return *text;
  }
  return std::nullopt;
}

std::optional<std::vector<Value>> Value::elements(std::size_t length, std::string_view expected) const {
  if (!json_->is_array() || json_->size() != length) {
    unexpected(expected);
    return std::nullopt;
  }
  std::vector<Value> elements;
  for (std::size_t i = 0; i < length; ++i)
    elements.emplace_back((*json_)[i], pointer_to(pointer_, i), *faults_);
  return elements;
}

std::vector<Value> Value::list(std::string_view expected, std::size_t most) const {
  std::vector<Value> elements;
  if (!json_->is_array())
    unexpected(expected);
  else if (json_->size() > most)
    fault("must have at most " + std::to_string(most) + " entries; it has " + std::to_string(json_->size()));
  else
    for (std::size_t i = 0; i < json_->size(); ++i)
      elements.emplace_back((*json_)[i], pointer_to(pointer_, i), *faults_);
  return elements;
}

std::optional<Object> Value::object() const {
  if (json_->is_object()) return Object(*this);
  unexpected("an object");
  return std::nullopt;
}

void Object::allow(const std::vector<std::string_view>& names, std::string_view what) const {
  for (const auto& [name, json] : value_.json().items()) {
    if (std::ranges::find(names, name) != names.end()) continue;
    if (value_.faults().is_full())
      value_.faults().add({}, {});  // is counted
    else
      Value(json, pointer_to(value_.pointer(), name), value_.faults())
          .fault("is not a member of " + std::string(what) + suggestion(name, names) +
                 "; allowed are: " + list_of(names));
  }
}

std::optional<Value> Object::find(std::string_view name) const {
  const auto member = value_.json().find(name);
  if (member == value_.json().end()) return std::nullopt;
  return Value(*member, pointer_to(value_.pointer(), name), value_.faults());
}

std::optional<Value> Object::require(std::string_view name, std::string_view purpose) const {
  auto member = find(name);
  if (!member)
    value_.faults().add(pointer_to(value_.pointer(), name), "is missing; it gives " + std::string(purpose));
  return member;
}

std::vector<std::pair<std::string, Value>> Object::members() const {
  std::vector<std::pair<std::string, Value>> members;
  for (const auto& [name, member] : value_.json().items())
    members.emplace_back(name, Value(member, pointer_to(value_.pointer(), name), value_.faults()));
  return members;
}

}  // namespace signorini::api
