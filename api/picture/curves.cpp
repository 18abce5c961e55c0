#include "api/picture/curves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "api/picture/plot.hpp"

namespace signorini::api {
namespace {

constexpr double width = 720, plot_left = 70, plot_right = 30, frame = width - plot_left - plot_right;

std::string with_plot_styles(std::string_view styles) {
  return std::string(plot_styles) + std::string(styles);
}

/// The arc length at each row: parts may have gaps, over which it runs on.
std::vector<double> arc_lengths(const ContactPart& part) {
  std::vector<double> lengths;
  double length = 0;
  for (std::size_t i = 0; i < part.points.size(); ++i) {
    if (i > 0) length += (part.points[i] - part.points[i - 1]).norm();
    lengths.push_back(length);
  }
  return lengths;
}

struct Strip {
  const ContactPart& part;
  const std::vector<double> lengths;
};

/// Half the length that a row stands for lies on either side of it.
void mark_closed(const Strip& strip, const Plot& plot) {
  const std::size_t count = strip.lengths.size();
  for (std::size_t i = 0, last = 0; i < count; i = last + 1) {
    last = i;
    if (strip.part.open[i]) continue;
    while (last + 1 < count && !strip.part.open[last + 1]) ++last;
    plot.draw_stretch(std::max(0., strip.lengths[i] - strip.part.weight[i] / 2),
                      std::min(strip.lengths.back(), strip.lengths[last] + strip.part.weight[last] / 2),
                      "closed");
  }
}

void draw_strip(Svg& svg, const Strip& strip, const std::vector<double>& values, std::string_view name,
                double top, double height) {
  Extent y;
  std::vector<Point> curve;
  for (std::size_t i = 0; i < values.size(); ++i) {
    y.include(values[i]);
    curve.emplace_back(strip.lengths[i], values[i]);
  }
  const Plot plot(svg, {plot_left, top}, {frame, height},
                  {0, strip.lengths.empty() ? 0 : strip.lengths.back()}, y);
  mark_closed(strip, plot);
  plot.draw_axes("arc length", name);
  plot.draw_curve(curve, "curve c0");
}

}  // namespace

void draw_contact(const std::vector<ContactPart>& parts, PieceWriter& out) {
  constexpr double height = 150, between = 75, of_part = 2 * (height + between);
  Svg svg(out, width, std::max<double>(80, 20 + of_part * static_cast<double>(parts.size())), "Contact",
          with_plot_styles(".c0{stroke:#0b62a4}.closed{fill:#f3e2c7}"));
  if (parts.empty()) svg.text({plot_left, 40}, "No part of the boundary is a contact.", "name");
  double top = 40;
  for (const ContactPart& part : parts) {
    const Strip strip{part, arc_lengths(part)};
    draw_strip(svg, strip, part.pressure, part.name + ": pressure (shaded where it touches)", top, height);
    draw_strip(svg, strip, part.clearance, part.name + ": clearance", top + height + between, height);
    top += of_part;
  }
  svg.end();
}

void draw_history(const std::vector<Iteration>& history, PieceWriter& out) {
  struct Curve {
    const char* name;
    const char* colour;
    double Iteration::*value;
  };
  static constexpr std::array curves{
      Curve{"equilibrium", "#0b62a4", &Iteration::equilibrium},
      Curve{"penetration", "#c8553d", &Iteration::penetration},
      Curve{"tension", "#3a7d44", &Iteration::tension},
      Curve{"complementarity", "#7b4ea3", &Iteration::complementarity},
      Curve{"change of the clearance", "#8a6d1d", &Iteration::clearance_change}};
  constexpr double height = 320, top = 60;
  std::string styles;
  for (std::size_t i = 0; i < curves.size(); ++i)
    styles.append(".c").append(std::to_string(i)).append("{stroke:").append(curves[i].colour).append("}");
  Svg svg(out, width, top + height + 50, "Residuals by iteration", with_plot_styles(styles));
  Extent y{std::numeric_limits<double>::infinity(), 0};
  for (const Iteration& row : history)
    for (const Curve& curve : curves)
      if (row.*curve.value > 0) y.include(row.*curve.value);
  if (!(y.high > 0)) y = {0.1, 1};
  const Plot plot(svg, {plot_left, top}, {frame, height}, {0, history.empty() ? 1. : history.back().number},
                  y, Plot::Scale::logarithmic);
  plot.draw_axes("iteration", "");
  double across = plot_left;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Point> values;
    for (const Iteration& row : history) values.emplace_back(row.number, row.*curves[i].value);
    if (std::ranges::none_of(values, [](const Point& value) { return value.y() > 0; })) continue;
    const std::string style = "curve c" + std::to_string(i);
    plot.draw_curve(values, style);
    svg.line({across, 30}, {across + 18, 30}, style);
    svg.text({across + 23, 34}, curves[i].name, "number");
    across += 45 + 6.2 * static_cast<double>(std::string_view(curves[i].name).size());
  }
  svg.end();
}

}  // namespace signorini::api
