#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace signorini::api {

/// The numbers of a typed array, as its tag tells (RFC 8746, 2).
struct ElementType {
  bool is_float = false;
  bool is_signed = false;
  bool little_endian = false;
  std::size_t bytes = 1;
};

/// Nothing for a tag of another meaning, and for numbers of 128 bits.
std::optional<ElementType> element_type(std::uint64_t tag);

/// A typed array; refers to its bytes, whole numbers of the type.
class TypedArray {
 public:
  TypedArray(ElementType type, std::string_view bytes) : type_(type), bytes_(bytes) {}

  bool is_float() const { return type_.is_float; }
  std::size_t size() const { return bytes_.size() / type_.bytes; }
  double operator[](std::size_t i) const;

 private:
  ElementType type_;
  std::string_view bytes_;
};

}  // namespace signorini::api
