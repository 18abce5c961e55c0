#include "mesh/unit_frame.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace signorini {
namespace {

Eigen::AlignedBox2d bounding_box(const std::vector<Point>& points) {
  Eigen::AlignedBox2d box;
  for (const Point& x : points) box.extend(x);
  return box;
}

double rounded(double x) {
  return std::ldexp(std::round(std::ldexp(x, 40)), -40);
}

}  // namespace

UnitFrame::UnitFrame(const std::vector<Point>& points) {
  const Eigen::AlignedBox2d box = bounding_box(points);
  low_ = box.min();
  extent_ = box.sizes().maxCoeff();
}

Point UnitFrame::into(const Point& x) const {
  const Point exact = scaled(x);
  return {rounded(exact.x()), rounded(exact.y())};
}

double UnitFrame::into(double length) const {
  int exponent = 0;
  const double fraction = std::frexp(length / extent_, &exponent);
  return std::ldexp(rounded(fraction), exponent);
}

std::string why_no_frame(const std::vector<Point>& points) {
  const Eigen::AlignedBox2d box = bounding_box(points);
  const double extent = points.empty() ? 0 : box.sizes().maxCoeff();
  if (extent == 0) return "all points are the same";
  if (!std::isnormal(extent * extent))
    return "the extent of the domain is too large or too small for its area to be a number: use other units";
  const double farthest = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
  if (farthest > 1e8 * extent)
    return "lies so far from the origin that its points cannot be told apart: move the origin closer";
  return {};
}

}  // namespace signorini
