#include "api/picture/svg.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

namespace signorini::api {
namespace {

/// A hundredth of a pixel is not seen.
double rounded(double length) {
  return std::round(100 * length) / 100 + 0.;  // no -0
}

Point rounded(const Point& point) {
  return {rounded(point.x()), rounded(point.y())};
}

}  // namespace

Svg::Svg(PieceWriter& out, double width, double height, std::string_view title, std::string_view styles)
    : out_(out) {
  out_.put("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" viewBox=\"0 0 ");
  out_.put_digits(rounded(width));
  out_.put(' ');
  out_.put_digits(rounded(height));
  out_.put('"');
  put("width", width);
  put("height", height);
  out_.put(">\n<title>");
  put_escaped(title);
  out_.put("</title>\n<style>text{font:13px system-ui,sans-serif;fill:#222}.paper{fill:#fff}");
  out_.put(styles);
  out_.put("</style>\n");
  rectangle(Point(0, 0), Vector(width, height), "paper");
}

void Svg::end() {
  out_.put("</svg>\n");
}

void Svg::line(const Point& from, const Point& to, std::string_view style) {
  begin_path(style);
  shape(std::array{from, to}, false);
  end_path();
}

void Svg::rectangle(const Point& corner, const Vector& size, std::string_view style) {
  out_.put("<rect class=\"");
  out_.put(style);
  out_.put('"');
  put("x", corner.x());
  put("y", corner.y());
  put("width", size.x());
  put("height", size.y());
  out_.put("/>\n");
}

void Svg::text(const Point& place, std::string_view text, std::string_view style, Anchor anchor) {
  constexpr std::array<std::string_view, 3> names{"start", "middle", "end"};
  out_.put("<text class=\"");
  out_.put(style);
  out_.put("\" text-anchor=\"");
  out_.put(names[static_cast<std::size_t>(anchor)]);
  out_.put('"');
  put("x", place.x());
  put("y", place.y());
  out_.put('>');
  put_escaped(text);
  out_.put("</text>\n");
}

void Svg::begin_path(std::string_view style) {
  out_.put("<path class=\"");
  out_.put(style);
  out_.put("\" d=\"");
}

void Svg::shape(std::span<const Point> points, bool closed) {
  if (points.empty()) return;
  Point last = rounded(points.front());
  out_.put('M');
  put(last);
  out_.put('l');
  bool is_first = true;
  for (const Point& point : points.subspan(1)) {
    const Point next = rounded(point);
    const Vector step = rounded(Point(next - last));
    if (!std::exchange(is_first, false) && step.x() >= 0) out_.put(' ');
    put(step);
    last = next;
  }
  if (closed) out_.put('z');
}

void Svg::end_path() {
  out_.put("\"/>\n");
}

void Svg::put(const Point& point) {
  out_.put_digits(point.x());
  if (point.y() >= 0) out_.put(' ');
  out_.put_digits(point.y());
}

void Svg::put(std::string_view name, double length) {
  out_.put(' ');
  out_.put(name);
  out_.put("=\"");
  out_.put_digits(rounded(length));
  out_.put('"');
}

/// What XML has no characters for, controls, U+FFFE and U+FFFF, is left out.
void Svg::put_escaped(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("\xef\xbf\xbe") || rest.starts_with("\xef\xbf\xbf"))
      i += 2;
    else if (text[i] == '<')
      out_.put("&lt;");
    else if (text[i] == '>')
      out_.put("&gt;");
    else if (text[i] == '&')
      out_.put("&amp;");
    else if (static_cast<unsigned char>(text[i]) >= ' ')
      out_.put(text[i]);
  }
}

std::string in_short(double number) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.3g", number);
  return text.data();
}

}  // namespace signorini::api
