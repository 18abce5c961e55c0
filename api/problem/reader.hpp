#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "api/document/json_pointer.hpp"
#include "api/names.hpp"
#include "api/wording.hpp"
#include "problem/field.hpp"

namespace signorini::api {

/// The number of code points of a text in UTF-8.
std::size_t characters(const std::string& text);

/// The faults of a document, in the order found. A reply stays readable, and a body full of faults is soon
/// refused: behind the hundredth they are only counted, as far as they are looked for at all.
class Faults {
 public:
  void add(std::string pointer, std::string detail);
  void add(const InvalidProblem& invalid);

  /// Whether there are more than are listed, so that the rest of a long list is not worth reading.
  bool is_full() const { return unlisted_ > 0; }

  /// Whether the value at the pointer, or one inside it, has a fault.
  bool has_any_at(std::string_view pointer) const;

  /// Throws InvalidProblem with all faults if there is one.
  void throw_if_any() const;

 private:
  static constexpr std::size_t most = 100;
  std::vector<Fault> faults_;
  std::size_t unlisted_ = 0;
};

class Object;

/// One value of the document and where it stands. Reading it as something that it is not adds a fault
/// that says what is expected and what was found, and answers nothing.
class Value {
 public:
  Value(const nlohmann::json& json, std::string pointer, Faults& faults)
      : json_(&json), pointer_(std::move(pointer)), faults_(&faults) {}

  const nlohmann::json& json() const { return *json_; }
  const std::string& pointer() const { return pointer_; }
  Faults& faults() const { return *faults_; }

  /// A number that meets the requirement; `expected` names both, such as `a positive number`.
  std::optional<double> number(std::string_view expected, const std::function<bool(double)>& meets) const;
  std::optional<double> number() const;
  std::optional<double> positive() const;

  /// A whole number from `least` to `most`.
  std::optional<int> integer(int least, int most) const;

  /// A text of at most so many characters.
  std::optional<std::string> text(std::size_t most) const;

  /// The elements of an array of the given length; `expected` describes it.
  std::optional<std::vector<Value>> elements(std::size_t length, std::string_view expected) const;

  /// The elements of an array of at most so many; none if it is no array or a longer one, which adds a fault.
  std::vector<Value> list(std::string_view expected, std::size_t most) const;

  /// The same of a list that is as long as the body allows: calls read(element) with each, until there are
  /// faults enough.
  template <typename Read>
  void for_each(std::string_view expected, const Read& read) const {
    if (!json_->is_array()) return unexpected(expected);
    for (std::size_t i = 0; i < json_->size() && !faults_->is_full(); ++i)
      read(Value((*json_)[i], pointer_to(pointer_, i), *faults_));
  }

  /// So many numbers in an array, without a word if it is anything else.
  template <std::size_t count>
  std::optional<std::array<double, count>> numbers() const {
    std::array<double, count> numbers;
    if (!json_->is_array() || json_->size() != count) return std::nullopt;
    for (std::size_t i = 0; i < count; ++i) {
      if (!(*json_)[i].is_number()) return std::nullopt;
      numbers[i] = (*json_)[i].get<double>();
    }
    return numbers;
  }

  std::optional<Object> object() const;

  /// One of the names of the table.
  template <typename T>
  std::optional<T> one_of(const Names<T>& table) const {
    const auto names = only_names(table);
    if (const std::string* word = json_->get_ptr<const std::string*>()) {
      for (const Named<T>& entry : table)
        if (entry.name == *word) return entry.value;
      fault("must be one of " + list_of(names) + "; not " + in_quotes(*word) + suggestion(*word, names));
    } else {
      unexpected("one of the strings " + list_of(names));
    }
    return std::nullopt;
  }

  /// Another value in the place of this one.
  Value instead(const nlohmann::json& json) const { return {json, pointer_, *faults_}; }

  void fault(std::string detail) const { faults_->add(pointer_, std::move(detail)); }

  /// Adds the fault that the value is not what is expected.
  void unexpected(std::string_view expected) const;

 private:
  const nlohmann::json* json_;
  std::string pointer_;
  Faults* faults_;
};

/// An object of the document.
class Object {
 public:
  explicit Object(const Value& value) : value_(value) {}

  /// Adds a fault for every member of another name; `what` says what has these members.
  void allow(const std::vector<std::string_view>& names, std::string_view what) const;

  std::optional<Value> find(std::string_view name) const;

  /// As find; adds a fault if the member is missing, which says what it is for.
  std::optional<Value> require(std::string_view name, std::string_view purpose) const;

  /// All members by name.
  std::vector<std::pair<std::string, Value>> members() const;

 private:
  Value value_;
};

}  // namespace signorini::api
