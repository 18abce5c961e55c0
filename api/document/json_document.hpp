#pragma once

#include <stdexcept>
#include <string_view>

#include <nlohmann/json.hpp>

#include "progress/observer.hpp"

namespace signorini::api {

/// A text that is not a JSON document as this service takes them (I-JSON, RFC 7493): a syntax error,
/// invalid UTF-8, a duplicate member, a number that overflows, more nesting, values, members or text than the
/// limits.
class MalformedJson : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws MalformedJson for a text that is no JSON document, whatever it holds and however much; nothing is
/// made of it. Members may be there twice.
void require_json(std::string_view text);

/// Parses a document strictly. Throws MalformedJson, whose text names the place (line and column, or the
/// JSON pointer of a duplicate member), and Cancelled if there is an observer who ends it.
nlohmann::json parse_json(std::string_view text, Observer* observer = nullptr);

}  // namespace signorini::api
