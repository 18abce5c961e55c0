#include "api/picture/colour_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace signorini::api {
namespace {

using Colour = std::array<int, 3>;
constexpr int kStops = 9;
using Stops = std::array<Colour, kStops>;

constexpr Stops viridis{{{0x44, 0x01, 0x54},
                         {0x47, 0x2c, 0x7a},
                         {0x3b, 0x51, 0x8b},
                         {0x2c, 0x71, 0x8e},
                         {0x21, 0x90, 0x8d},
                         {0x27, 0xad, 0x81},
                         {0x5c, 0xc8, 0x63},
                         {0xaa, 0xdc, 0x32},
                         {0xfd, 0xe7, 0x25}}};

constexpr Stops blue_to_red{{{0x21, 0x66, 0xac},
                             {0x43, 0x93, 0xc3},
                             {0x92, 0xc5, 0xde},
                             {0xd1, 0xe5, 0xf0},
                             {0xf7, 0xf7, 0xf7},
                             {0xfd, 0xdb, 0xc7},
                             {0xf4, 0xa5, 0x82},
                             {0xd6, 0x60, 0x4d},
                             {0xb2, 0x18, 0x2b}}};

}  // namespace

ColourMap::ColourMap(double low, double high)
    : diverges_(low < 0 && high > 0 && std::min(-low, high) > std::max(-low, high) / 50),
      is_single_(high / 2 - low / 2 <= 1e-10 * std::max(std::abs(low), std::abs(high))),
      low_(low),
      high_(high) {
  if (is_single_) {
    const double width = low == 0 ? 1 : std::abs(low) / 2;
    low_ = low - width;
    high_ = low + width;
  } else if (diverges_) {
    high_ = std::max(high, -low);
    low_ = -high_;
  }
}

int ColourMap::band(double value) const {
  if (is_single_) return kBands / 2;
  // Halves, as the difference of large numbers may leave the range of double precision.
  const double share = (value / 2 - low_ / 2) / (high_ / 2 - low_ / 2);
  return static_cast<int>(std::clamp(share * kBands, 0., kBands - 1.));
}

std::string ColourMap::colour(int band) const {
  const Stops& stops = diverges_ ? blue_to_red : viridis;
  const double place = band * (kStops - 1.) / (kBands - 1);
  const int before = std::min(static_cast<int>(place), kStops - 2);
  const double way = place - before;
  Colour own;
  for (std::size_t i = 0; i < own.size(); ++i)
    own[i] = static_cast<int>(std::lround((1 - way) * stops[before][i] + way * stops[before + 1][i]));
  std::array<char, 8> text;
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", own[0], own[1], own[2]);
  return text.data();
}

}  // namespace signorini::api
