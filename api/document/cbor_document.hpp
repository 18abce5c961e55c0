#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace signorini::api {

/// Bytes that are no CBOR document, or one that has no JSON: a number that is not finite, bytes that are no
/// typed array, keys that are no text, other tags, strings of indefinite length, nesting deeper than 64.
class MalformedCbor : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The JSON text of a CBOR document (RFC 8949): text that parse_json() then takes or refuses. Arrays of
/// numbers may be typed arrays (RFC 8746), those of several extents within tag 40. Nothing if the text would
/// be longer than that many bytes. Throws MalformedCbor, whose text names the byte.
std::optional<std::string> json_of_cbor(std::string_view bytes, std::size_t longest);

}  // namespace signorini::api
