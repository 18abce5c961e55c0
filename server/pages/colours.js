// Colours for values, the same as in the pictures that the service draws (api/picture/colour_map.cpp): viridis for
// magnitudes, for signed values ColorBrewer's RdBu, whose middle is 0. Both are safe for the colour-blind.

const viridis = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
const blueToRed = [[33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [247, 247, 247], [253, 219, 199], [244, 165, 130], [214, 96, 77], [178, 24, 43]];

/// What the colours mean: `low`, `high`, and whether they diverge at 0. The range of signed values is widened until 0
/// is in its middle, unless one sign has less than a fiftieth of the other's size; values that differ by rounding are
/// one.
export function scaleOf(low, high) {
  if (high / 2 - low / 2 <= 1e-10 * Math.max(Math.abs(low), Math.abs(high))) {
    const width = low === 0 ? 1 : Math.abs(low) / 2;
    return { low: low - width, high: low + width, diverges: false };
  }
  const size = Math.max(high, -low);
  if (!(Math.min(high, -low) > size / 50)) return { low, high, diverges: false };
  return { low: -size, high: size, diverges: true };
}

/// The colour at a share from 0 to 1 of the scale, as three numbers to 255.
export function colour(share, diverges) {
  const stops = diverges ? blueToRed : viridis;
  const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1), before = Math.min(Math.floor(place), stops.length - 2);
  return stops[before].map((each, i) => Math.round(each + (place - before) * (stops[before + 1][i] - each)));
}
