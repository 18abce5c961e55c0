#pragma once

#include <string>

namespace signorini::api {

/// Colours for the values from `low` to `high`: viridis (van der Walt, Smith 2015) for magnitudes, which is
/// perceptually even and safe for the colour-blind; for signed values ColorBrewer's RdBu, whose middle is 0.
/// Where one sign has less than a fiftieth of the other's size, as rounding and small overshoots have, half
/// of the colours would go to it: such values are magnitudes too.
class ColourMap {
 public:
  static constexpr int kBands = 32;

  /// The range of signed values is widened until 0 is in its middle. Values that differ by rounding are one,
  /// with a colour from the middle of a range about it.
  ColourMap(double low, double high);

  double low() const { return low_; }
  double high() const { return high_; }

  /// The band of a value, from 0 to kBands − 1; the nearest one for values outside.
  int band(double value) const;
  /// The value at the lower end of a band.
  double start_of(int band) const { return low_ + (high_ / kBands - low_ / kBands) * band; }
  /// `#rrggbb`
  std::string colour(int band) const;

 private:
  bool diverges_, is_single_;
  double low_, high_;
};

}  // namespace signorini::api
