#pragma once

#include <span>
#include <string>
#include <string_view>

#include "api/document/piece_writer.hpp"
#include "problem/field.hpp"

namespace signorini::api {

/// Writes the elements of an SVG picture. Lengths are pixels, y points down; `style` is the name of a class
/// of the style sheet.
class Svg {
 public:
  enum class Anchor { start, middle, end };

  /// Begins a picture of this size with what it is called for those who cannot see it.
  Svg(PieceWriter& out, double width, double height, std::string_view title, std::string_view styles);

  void end();

  void line(const Point& from, const Point& to, std::string_view style);
  void rectangle(const Point& corner, const Vector& size, std::string_view style);
  void text(const Point& place, std::string_view text, std::string_view style, Anchor anchor = Anchor::start);

  /// Closed shapes of one style, or open ones, in one element: begin, any number of shapes, end. A point is
  /// written as the step from the one before; none is no shape.
  void begin_path(std::string_view style);
  void shape(std::span<const Point> points, bool closed);
  void end_path();

 private:
  void put(const Point& point);
  void put(std::string_view name, double length);
  void put_escaped(std::string_view text);

  PieceWriter& out_;
};

/// A number for people: three digits.
std::string in_short(double number);

}  // namespace signorini::api
