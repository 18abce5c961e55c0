#include "curve_notes.hpp"

#include <algorithm>
#include <map>

#include "mesh/parts.hpp"

namespace signorini {
namespace {

bool is_closed(const ContactEdge& contact, const Eigen::VectorXd& clearance) {
  return clearance[contact.rows[0]] <= 0 || clearance[contact.rows[1]] <= 0;
}

/// The normal where an edge begins or ends, and whether it touches.
struct Side {
  int part;
  Vector normal;
  bool touches;
};

/// The body turns left by less than a right angle from the side that ends in a point to the one that begins;
/// by so little an angle that no mesh shows the pressure there does not count.
bool bends_outwards(const Vector& before, const Vector& after) {
  constexpr double little = 5e-5;
  return before.x() * after.y() - before.y() * after.x() > little && before.dot(after) > 1e-9;
}

/// By part the number of corners where the contact bends outwards and touches, and one of them.
struct Corners {
  int count = 0;
  Point one{0, 0};
};

std::map<int, Corners> touching_corners(const Discretization& discrete, const Eigen::VectorXd& clearance) {
  const Mesh& mesh = discrete.mesh;
  std::map<int, Side> ending, beginning;
  for (const ContactEdge& contact : discrete.clearance.edges) {
    const int part = discrete.clearance.rows[contact.rows[0]].part;
    const auto [from, to] = domain_on_the_left(mesh, contact.edge);
    const auto side = [&](int point) {
      const int end = mesh.edges[contact.edge][0] == point ? 0 : 1;
      return Side{part, mesh.on_boundary(contact.edge, end).normal, is_closed(contact, clearance)};
    };
    // Along a direction of its own nothing bends.
    const auto& condition = *condition_on<Contact>(discrete.problem, mesh.boundary[part].name);
    if (!condition.direction.isZero(0)) continue;
    beginning.insert_or_assign(from, side(from));
    ending.insert_or_assign(to, side(to));
  }
  std::map<int, Corners> corners;
  for (const auto& [point, before] : ending) {
    const auto after = beginning.find(point);
    if (after == beginning.end() || !bends_outwards(before.normal, after->second.normal)) continue;
    if (!before.touches && !after->second.touches) continue;
    Corners& own = corners[before.part];
    ++own.count;
    own.one = mesh.points[point];
  }
  return corners;
}

}  // namespace

std::vector<std::string> notes_on_curves(const Discretization& discrete, const Eigen::VectorXd& clearance) {
  std::vector<std::string> notes;
  if (discrete.spaces().components == 2)
    for (const auto& [part, corners] : touching_corners(discrete, clearance))
      notes.push_back(
          "the contact " + discrete.mesh.boundary[part].name + " bends outwards where it touches, at " +
          std::to_string(corners.count) + (corners.count == 1 ? " corner, " : " corners such as ") +
          to_string(corners.one) +
          ": there the true pressure of this polygon is infinite, and max_pressure grows as the mesh "
          "gets finer; if it stands for a curve, make it arcs, or give the contact a direction");
  if (!discrete.mesh.circles.empty())
    notes.push_back(
        "the error bound is of the body that the mesh is, with chords for its arcs and the data read on the "
        "arcs; "
        "how far the chords are from the arcs is not in it");
  return notes;
}

}  // namespace signorini
