#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "api/picture/svg.hpp"

namespace signorini::api {

/// What a plot needs of the style sheet.
extern const std::string_view plot_styles;

/// From the smallest to the largest value of an axis.
struct Extent {
  double low = 0, high = 0;

  void include(double value);
};

/// A frame with two axes in which curves are drawn.
class Plot {
 public:
  enum class Scale { linear, logarithmic };

  /// A logarithmic axis is that of y, and holds positive values only.
  Plot(Svg& svg, const Point& corner, const Vector& size, Extent x, Extent y, Scale scale = Scale::linear);

  /// The frame, ticks with their numbers, and what the axes are called.
  void draw_axes(std::string_view x_name, std::string_view y_name) const;

  /// One curve; it is interrupted where a value is not finite or, on a logarithmic axis, not positive.
  void draw_curve(const std::vector<Point>& values, std::string_view style) const;

  /// A strip from one x to another.
  void draw_stretch(double from, double to, std::string_view style) const;

 private:
  Point place(double x, double y) const;
  void draw_ticks_of_x() const;
  void draw_ticks_of_y() const;

  Svg& svg_;
  const Point corner_;
  const Vector size_;
  Extent x_, y_;
  const Scale scale_;
};

}  // namespace signorini::api
