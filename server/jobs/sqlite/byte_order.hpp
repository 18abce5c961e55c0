#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace signorini::server {

/// The number that stands in `count` bytes, at most four, from the offset on, the highest first.
inline std::uint32_t big_endian(std::string_view bytes, std::size_t offset, std::size_t count = 4) {
  std::uint32_t number = 0;
  for (std::size_t i = 0; i < count; ++i) number = number << 8 | static_cast<std::uint8_t>(bytes[offset + i]);
  return number;
}

/// The same with the lowest first.
inline std::uint32_t little_endian(std::string_view bytes, std::size_t offset, std::size_t count = 4) {
  std::uint32_t number = 0;
  for (std::size_t i = count; i-- > 0;) number = number << 8 | static_cast<std::uint8_t>(bytes[offset + i]);
  return number;
}

}  // namespace signorini::server
