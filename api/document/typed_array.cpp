#include "api/document/typed_array.hpp"

#include <bit>

#include <Eigen/Core>

namespace signorini::api {
namespace {

/// Bits of a number that is a two's complement of so many bytes.
std::int64_t sign_extended(std::uint64_t bits, std::size_t bytes) {
  const std::size_t unused = 64 - 8 * bytes;
  return static_cast<std::int64_t>(bits << unused) >> unused;
}

double real(std::uint64_t bits, std::size_t bytes) {
  if (bytes == 8) return std::bit_cast<double>(bits);
  if (bytes == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  return static_cast<double>(std::bit_cast<Eigen::half>(static_cast<std::uint16_t>(bits)));
}

}  // namespace

std::optional<ElementType> element_type(std::uint64_t tag) {
  // 0b010fsell: float, signed, little endian, size.
  if (tag < 64 || tag > 87) return std::nullopt;
  ElementType type{(tag & 16) != 0, (tag & 8) != 0, (tag & 4) != 0, std::size_t{1} << (tag & 3)};
  if (type.is_float) type.bytes *= 2;
  // Of a single byte there is no little endian: 68 has unsigned numbers that were clamped, 76 no meaning.
  if (tag == 76 || type.bytes > 8) return std::nullopt;
  return type;
}

double TypedArray::operator[](std::size_t i) const {
  const std::string_view own = bytes_.substr(i * type_.bytes, type_.bytes);
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < own.size(); ++k)
    bits = bits << 8 | static_cast<std::uint8_t>(own[type_.little_endian ? own.size() - 1 - k : k]);
  if (type_.is_float) return real(bits, type_.bytes);
  return type_.is_signed ? static_cast<double>(sign_extended(bits, type_.bytes)) : static_cast<double>(bits);
}

}  // namespace signorini::api
