#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <sstream>

#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"
#include "mesh/domain_mesh.hpp"

namespace signorini::api {
namespace {

std::string digits(double value) {
  std::ostringstream text;
  text.precision(17);
  text << '(' << value << ')';
  return text.str();
}

/// Doubles hold its square, and one over that.
bool has_a_square(double length) {
  return std::isnormal(length * length) && std::isnormal(1 / (length * length));
}

/// (x − from)·(to − from) / |to − from|²: 0 at the one point, 1 at the other.
std::string along(const Point& from, const Point& to) {
  const Vector way = (to - from) / (to - from).squaredNorm();
  return "((x - " + digits(from.x()) + ") * " + digits(way.x()) + " + (y - " + digits(from.y()) + ") * " +
         digits(way.y()) + ")";
}

Field formula(const Value& value, const std::string& text) {
  return Field(parse_formula(text, true), value.pointer());
}

/// The points of a weight, no two neighbours of which may be the same.
std::optional<std::vector<Point>> read_points(const Value& value, std::size_t count,
                                              std::string_view expected) {
  const auto entries = value.elements(count, expected);
  if (!entries) return std::nullopt;
  std::vector<Point> points;
  for (const Value& entry : *entries) {
    const auto point = read_pair(entry, "a point, [x, y]", false);
    if (!point) return std::nullopt;
    if (!points.empty() && points.back() == *point) {
      entry.fault("is the point before it: give points one after the other along the part");
      return std::nullopt;
    }
    if (!points.empty() && !has_a_square((*point - points.back()).norm())) {
      entry.fault("is nearer to the point before it, or further off, than double precision can tell");
      return std::nullopt;
    }
    points.push_back(*point);
  }
  return points;
}

/// Positive of corners that go around it to the left.
double signed_area(const std::vector<Point>& corners) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vector one = corners[i] - corners[0], other = corners[i + 1] - corners[0];
    twice += one.x() * other.y() - one.y() * other.x();
  }
  return twice / 2;
}

/// 1 over the area in a polygon and 0 beside it: the triangles from its first corner, counted as they go
/// around, add up to it.
std::string mean_over(const std::vector<Point>& corners, double area) {
  const auto is_left = [](const Point& a, const Point& b) {
    return "(" + digits(b.x() - a.x()) + " * (y - " + digits(a.y()) + ") > " + digits(b.y() - a.y()) +
           " * (x - " + digits(a.x()) + "))";
  };
  std::string sum = "0";
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    std::vector<Point> own{corners[0], corners[i], corners[i + 1]};
    const bool turns = signed_area(own) < 0;
    if (turns) std::swap(own[1], own[2]);
    sum += " + (" + is_left(own[0], own[1]) + " && " + is_left(own[1], own[2]) + " && " +
           is_left(own[2], own[0]) + " ? " + digits((turns ? -1 : 1) / area) + " : 0)";
  }
  return sum;
}

/// 0 beyond the first and the last point, 1 between the two in the middle.
std::string trapezoid(const Point& a, const Point& b, const Point& c, const Point& d) {
  return "max(0, min(1, min(" + along(a, b) + ", " + along(d, c) + ")))";
}

std::optional<Field> read_linear(const Value& value) {
  const auto entries = value.elements(2, "an array of two points with weights, [[x0, y0, w0], [x1, y1, w1]]");
  if (!entries) return std::nullopt;
  std::array<std::array<double, 3>, 2> ends;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto numbers = (*entries)[i].numbers<3>();
    if (!numbers) {
      (*entries)[i].unexpected("an array of three numbers, [x, y, w]");
      return std::nullopt;
    }
    ends[i] = *numbers;
  }
  const Point from(ends[0][0], ends[0][1]), to(ends[1][0], ends[1][1]);
  if (from == to) {
    value.fault("has the same point twice: give two points of the part");
    return std::nullopt;
  }
  if (!has_a_square((to - from).norm()) || !std::isfinite(ends[1][2] - ends[0][2])) {
    value.fault("has points or weights that differ by less or more than double precision can tell");
    return std::nullopt;
  }
  return formula(value,
                 digits(ends[0][2]) + " + " + digits(ends[1][2] - ends[0][2]) + " * " + along(from, to));
}

std::optional<Field> read_weight(const Value& value) {
  const auto object = value.object();
  if (!object) return std::nullopt;
  object->allow({"linear", "hat", "trapezoid"}, "a weight");
  if (value.json().size() != 1) {
    value.fault("must have one of linear, hat and trapezoid");
    return std::nullopt;
  }
  if (const auto linear = object->find("linear")) return read_linear(*linear);
  if (const auto hat = object->find("hat")) {
    const auto points = read_points(*hat, 3, "an array of three points, [begin, peak, end]");
    if (!points) return std::nullopt;
    const auto& [a, b, c] = std::tie((*points)[0], (*points)[1], (*points)[2]);
    return formula(*hat, trapezoid(a, b, b, c));
  }
  const auto given = object->find("trapezoid");
  const auto points = given ? read_points(*given, 4, "an array of four points, [a, b, c, d]") : std::nullopt;
  if (!points) return std::nullopt;
  return formula(*given, trapezoid((*points)[0], (*points)[1], (*points)[2], (*points)[3]));
}

/// Reads the quantities of one problem, whose model and conditions say what there can be.
class Quantities {
 public:
  Quantities(Model model, const Problem& problem)
      : model_(model), problem_(problem), names_(part_names(problem.domain)) {}

  void read(const Value& value) {
    const auto object = value.object();
    if (!object) return;
    quantity_ = {};
    read_name(*object);
    const auto type = object->require("type", "what is asked for: " + list_of(only_names(types())));
    const auto read_type = type ? type->one_of(types()) : std::nullopt;
    if (read_type) (this->**read_type)(*object);
    all_.push_back(quantity_);
  }

  std::vector<Quantity> take() { return std::move(all_); }

 private:
  using ReadType = void (Quantities::*)(const Object&);

  static const Names<ReadType>& types() {
    static const Names<ReadType> all{{"pressure_force", &Quantities::read_pressure_force},
                                     {"opening", &Quantities::read_opening},
                                     {"reaction", &Quantities::read_reaction},
                                     {"mean_displacement", &Quantities::read_mean_displacement}};
    return all;
  }

  void read_name(const Object& object) {
    const auto name = object.require("name", "the name by which the quantity is found in the result");
    const auto text = name ? name->text(limits::part_name) : std::nullopt;
    if (!text) return;
    if (text->empty()) name->fault("must not be empty");
    if (!known_.insert(*text).second) name->fault("is the name of another quantity, too");
    quantity_.name = *text;
  }

  template <typename Kind>
  bool has(const std::string& part) const {
    return condition_on<Kind>(problem_, part) != nullptr;
  }

  /// The name of a part that is fit, by `is_fit`; `expected` says what it must be.
  template <typename IsFit>
  std::optional<std::string> read_part(const Value& value, const IsFit& is_fit, std::string_view expected) {
    const auto part = value.text(limits::part_name);
    if (!part) return std::nullopt;
    if (std::ranges::find(names_, *part) == names_.end()) {
      const std::vector<std::string_view> known(names_.begin(), names_.end());
      value.fault("the domain has no part " + in_quotes(*part) + suggestion(*part, known) +
                  "; known are: " + list_of(known));
    } else if (!is_fit(*part)) {
      value.fault("must be " + std::string(expected));
    } else {
      return part;
    }
    return std::nullopt;
  }

  void read_pressure_force(const Object& object) { read_weighed(object, quantity_.weights); }
  void read_opening(const Object& object) { read_weighed(object, quantity_.openings); }

  void read_weighed(const Object& object, std::map<std::string, Field>& weights) {
    object.allow({"name", "type", "part", "weight"}, "a quantity of a contact");
    const auto member = object.require("part", "the contact that is asked about");
    const auto part =
        member ? read_part(
                     *member, [&](const auto& name) { return has<Contact>(name); }, "a part with a contact")
               : std::nullopt;
    Field weight(1);
    if (const auto given = object.find("weight")) weight = read_weight(*given).value_or(weight);
    if (part) weights.emplace(*part, weight);
  }

  /// A direction of an elastic body, of length 1; of a membrane there is but one.
  Vector read_direction(const Object& object) {
    const auto value = object.find("direction");
    if (model_ == Model::membrane) {
      if (value) value->fault("a membrane moves in one direction only: leave it out");
      return {1, 0};
    }
    const auto pair = value ? read_pair(*value, "a vector of two numbers, [dx, dy]", false) : std::nullopt;
    if (value && pair && pair->isZero(0)) value->fault("must not be zero");
    return pair && !pair->isZero(0) ? Vector(pair->stableNormalized()) : Vector(1, 0);
  }

  VectorField times(const Vector& direction, const Field& field) const {
    const auto component = [&](double factor) { return Field(0, field.name()).plus(factor, field); };
    if (model_ == Model::membrane) return {component(1)};
    return {component(direction.x()), component(direction.y())};
  }

  void read_reaction(const Object& object) {
    object.allow({"name", "type", "part", "direction", "about"}, "a reaction");
    const auto member = object.require("part", "the support that is asked about");
    const auto part =
        member ? read_part(
                     *member, [&](const auto& name) { return has<Fixed>(name) || has<Roller>(name); },
                     "a part that is fixed or on rollers")
               : std::nullopt;
    SupportMotion motion{{1, 0}, 0};
    const auto about = object.find("about");
    if (member && model_ == Model::elasticity && about.has_value() == object.find("direction").has_value())
      member->fault("needs either a direction, of the force, or a point that the moment is about");
    if (about && model_ == Model::membrane) about->fault("a membrane has no moments: leave it out");
    if (about) {
      const Point centre = read_pair(*about, "a point, [x, y]", false).value_or(Point(0, 0));
      motion = {{centre.y(), -centre.x()}, 1};
    } else {
      motion.translation = read_direction(object);
    }
    if (part) quantity_.motions.emplace(*part, motion);
  }

  void read_mean_displacement(const Object& object) {
    object.allow({"name", "type", "part", "disc", "polygon", "direction"}, "a mean displacement");
    const auto part = object.find("part"), disc = object.find("disc"), polygon = object.find("polygon");
    if (part.has_value() + disc.has_value() + polygon.has_value() != 1) {
      object.require("part", "the part over which the mean is taken, if no disc or polygon is given");
      if (part) part->fault("must not stand beside a disc or polygon");
      if (disc && polygon) disc->fault("must not stand beside a polygon");
    }
    const Vector direction = read_direction(object);
    if (model_ == Model::elasticity)
      object.require("direction", "the direction in which the displacement is measured");
    if (part) {
      const auto moves = [&](const auto& name) {
        return !has<Fixed>(name) && !has<Roller>(name) && !has<Contact>(name);
      };
      const auto name = read_part(*part, moves, "a part that is free or has a traction");
      quantity_.is_mean = true;
      if (name) quantity_.densities.emplace(*name, times(direction, Field(1, part->pointer())));
    } else if (disc) {
      read_disc(*disc, direction);
    } else if (polygon) {
      read_outline(*polygon, direction);
    }
  }

  void read_outline(const Value& value, const Vector& direction) {
    Outline outline{{}, value.pointer()};
    bool is_sound = value.json().is_array();
    value.for_each("an array of points, [x, y]", [&](const Value& entry) {
      const auto point = read_pair(entry, "a point, [x, y]", false);
      is_sound = is_sound && point;
      if (point) outline.corners.push_back(*point);
    });
    if (!is_sound) return;
    const std::size_t n = outline.corners.size();
    if (n < 3 || n > limits::outline_corners) {
      value.fault("must have 3 to " + std::to_string(limits::outline_corners) + " corners");
      return;
    }
    const double area = signed_area(outline.corners);
    if (!std::isnormal(area) || !std::isnormal(1 / area)) {
      value.fault("has an area that is 0, or smaller or larger than double precision can tell");
      return;
    }
    quantity_.density = times(direction, formula(value, mean_over(outline.corners, area)));
    quantity_.outline = std::move(outline);
  }

  void read_disc(const Value& value, const Vector& direction) {
    const auto disc = value.object();
    if (!disc) return;
    disc->allow({"centre", "radius"}, "a disc");
    const auto centre_value = disc->require("centre", "a point, [x, y]"),
               radius_value = disc->require("radius", "a length");
    const auto centre = centre_value ? read_pair(*centre_value, "a point, [x, y]", false) : std::nullopt;
    const auto radius = radius_value ? radius_value->positive() : std::nullopt;
    if (!centre || !radius) return;
    if (!has_a_square(*radius)) {
      radius_value->fault("is smaller or larger than double precision can square");
      return;
    }
    const std::string square = digits(*radius * *radius);
    const Field density = formula(value, "(x - " + digits(centre->x()) + ")^2 + (y - " + digits(centre->y()) +
                                             ")^2 < " + square + " ? 1 / (pi * " + square + ") : 0");
    quantity_.density = times(direction, density);
    quantity_.disc = Disc{*centre, *radius, value.pointer()};
  }

  const Model model_;
  const Problem& problem_;
  const std::vector<std::string> names_;
  std::set<std::string> known_;
  Quantity quantity_;
  std::vector<Quantity> all_;
};

}  // namespace

std::vector<Quantity> read_quantities(const Value& value, Model model, const Problem& problem) {
  // A domain with a fault has no parts that could be asked for.
  if (value.faults().has_any_at("/domain") || value.faults().has_any_at("/boundary")) return {};
  Quantities quantities(model, problem);
  for (const Value& entry : value.list("an array of quantities, {name, type, …}", limits::quantities))
    quantities.read(entry);
  return quantities.take();
}

}  // namespace signorini::api
