#include "api/picture/plot.hpp"

#include <algorithm>
#include <cmath>

namespace signorini::api {
namespace {

/// About five round numbers: 1, 2 or 5 times a power of ten apart.
std::vector<double> ticks(const Extent& extent) {
  const double rough = (extent.high - extent.low) / 5, power = std::pow(10, std::floor(std::log10(rough)));
  double step = 10 * power;
  for (const double digit : {5, 2, 1})
    if (digit * power >= rough) step = digit * power;
  std::vector<double> all;
  for (double k = std::ceil(extent.low / step); k * step <= extent.high; ++k)
    all.push_back(k * step + 0.);  // not −0
  return all;
}

/// Has some width, and one that is finite.
Extent widened(Extent extent) {
  constexpr double largest = 1e300;
  extent = {std::max(extent.low, -largest), std::min(extent.high, largest)};
  if (!(extent.high > extent.low)) {
    const double size = extent.low == 0 ? 1 : std::abs(extent.low);
    extent = {extent.low - size, extent.low + size};
  }
  return extent;
}

}  // namespace

const std::string_view plot_styles =
    ".axis{fill:none;stroke:#222;stroke-width:1}.grid{fill:none;stroke:#ddd;stroke-width:1}"
    ".number{font-size:11px}.curve{fill:none;stroke-width:1.6;stroke-linejoin:round}";

void Extent::include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

Plot::Plot(Svg& svg, const Point& corner, const Vector& size, Extent x, Extent y, Scale scale)
    : svg_(svg), corner_(corner), size_(size), x_(widened(x)), y_(y), scale_(scale) {
  if (scale == Scale::logarithmic) y_ = {std::floor(std::log10(y.low)), std::ceil(std::log10(y.high))};
  y_ = widened(y_);
}

Point Plot::place(double x, double y) const {
  if (scale_ == Scale::logarithmic) y = std::log10(y);
  return corner_ + Vector(size_.x() * (x - x_.low) / (x_.high - x_.low),
                          size_.y() * (y_.high - y) / (y_.high - y_.low));
}

void Plot::draw_axes(std::string_view x_name, std::string_view y_name) const {
  draw_ticks_of_x();
  draw_ticks_of_y();
  svg_.rectangle(corner_, size_, "axis");
  svg_.text(corner_ + Vector(0, -8), y_name, "name");
  svg_.text(corner_ + size_ + Vector(0, 32), x_name, "name", Svg::Anchor::end);
}

void Plot::draw_ticks_of_x() const {
  const double bottom = corner_.y() + size_.y();
  for (const double x : ticks(x_)) {
    const double across = corner_.x() + size_.x() * (x - x_.low) / (x_.high - x_.low);
    svg_.line({across, corner_.y()}, {across, bottom}, "grid");
    svg_.text({across, bottom + 15}, in_short(x), "number", Svg::Anchor::middle);
  }
}

/// Of a logarithmic axis powers of ten, not more than fit.
void Plot::draw_ticks_of_y() const {
  std::vector<double> exponents = ticks(y_);
  if (scale_ == Scale::logarithmic) {
    const auto is_fraction = [](double exponent) { return exponent != std::round(exponent); };
    exponents.erase(std::remove_if(exponents.begin(), exponents.end(), is_fraction), exponents.end());
  }
  for (const double y : exponents) {
    const double down = corner_.y() + size_.y() * (y_.high - y) / (y_.high - y_.low);
    svg_.line({corner_.x(), down}, {corner_.x() + size_.x(), down}, "grid");
    const std::string number = scale_ == Scale::logarithmic ? "1e" + in_short(y) : in_short(y);
    svg_.text({corner_.x() - 6, down + 4}, number, "number", Svg::Anchor::end);
  }
}

void Plot::draw_curve(const std::vector<Point>& values, std::string_view style) const {
  svg_.begin_path(style);
  std::vector<Point> run;
  for (const Point& value : values) {
    if (value.allFinite() && (scale_ == Scale::linear || value.y() > 0)) {
      run.push_back(place(value.x(), value.y()));
    } else {
      svg_.shape(run, false);
      run.clear();
    }
  }
  svg_.shape(run, false);
  svg_.end_path();
}

void Plot::draw_stretch(double from, double to, std::string_view style) const {
  const double left = place(from, 1).x(), right = place(to, 1).x();
  svg_.rectangle({left, corner_.y()}, {right - left, size_.y()}, style);
}

}  // namespace signorini::api
