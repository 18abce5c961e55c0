#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "problem/domain.hpp"
#include "problem/field.hpp"
#include "problem/material.hpp"
#include "problem/quantity.hpp"

namespace signorini {

/// u = value.
struct Fixed {
  VectorField value;
};

/// u_n = motion · n and no tangential stress; elasticity only. No problem that is read moves its rollers,
/// dual_problem() does.
struct Roller {
  SupportMotion motion = {};
};

/// σ n = value. A part without a condition is free: traction 0.
struct Traction {
  VectorField value;
};

/// σ n = −value n + besides: a pressure on an elastic body, and what acts there beside it.
struct Pressure {
  Field value;
  VectorField besides = {};
};

/// u_n ≤ gap, σ_n ≤ 0, (u_n − gap) σ_n = 0, σ_T = 0. For an elastic body u_n = u·n and σ_n = n·σn; for the
/// membrane u_n = −u and σ_n = −σ·n (solver/README.md, "The problem"). A negative gap is an initial overlap.
///
/// A direction d of any length, for an elastic body only, takes the place of the normal: u_d = u·d/|d|, and
/// the reaction acts along −d. For a foundation with a normal of its own, such as a plane, −d is that normal.
/// It must point out of the body on every edge of the part.
///
/// On an arc the gap is that of the arc's points, with the arc's normal (fem/clearance_space.hpp); so are the
/// data of all other conditions, but that a pressure acts along the normal of the chord.
struct Contact {
  Field gap;
  Vector direction = Vector::Zero();  ///< zero stands for the normal

  /// d/|d| where the boundary has this outward normal.
  Vector unit_direction(const Vector& normal) const {
    return direction.isZero(0) ? normal : Vector(direction.stableNormalized());
  }
};

using Condition = std::variant<Fixed, Roller, Traction, Pressure, Contact>;

/// The pairs of spaces of section 4 of the paper: `conforming` RT1–P1–P1 continuous, `nonconforming`
/// RT0–P0–P0 (stress rows, displacement, clearance). For elasticity a P1 continuous rotation imposes the
/// symmetry of the stress weakly, and the nonconforming rows take the curl of the cubic bubble in (PEERS).
enum class Scheme { conforming, nonconforming };

/// The unilateral contact problem, (2.3) of the paper for an elastic body and (6.1) with general data for a
/// membrane: −div σ = body in the domain, the material's law, a condition on every part of the boundary.
struct Problem {
  Domain domain;
  MeshRequest mesh;
  Material material = MembraneStiffness{};
  VectorField body;
  std::map<std::string, Condition> boundary;
  Scheme scheme = Scheme::nonconforming;
  std::vector<Quantity> quantities;  ///< that are asked for

  /// A text that two problems have in common only if their meshes, materials, kinds of conditions and schemes
  /// are the same, whatever their gaps, loads and boundary values: who has read the fields can tell, the
  /// solver cannot. Empty: not known, so that nothing is kept or reused for this problem.
  std::string operator_key;
  /// In the same way for the loads, tractions and boundary values: two problems that have both keys in common
  /// differ in their gaps at most.
  std::string load_key;
};

/// The data of a problem anew, on its mesh. But for another material its operator is as it was.
struct Variation {
  std::string title;
  VectorField body;
  std::map<std::string, Condition> boundary;  ///< those that differ, of the same kinds as the problem's
  std::string load_key;
  std::shared_ptr<const Material> material = {};  ///< null: the problem's own
  /// In the way of the problem's keys: two variations have it in common only if their materials are the same.
  std::string material_key = {};
};

/// Gives a problem that may have been varied before the data of another variation of the original.
void apply(const Variation& variation, const Problem& original, Problem& varied);

/// The condition of the given kind on the part, or null if the part has another one or none.
template <typename Kind>
const Kind* condition_on(const Problem& problem, const std::string& part) {
  const auto found = problem.boundary.find(part);
  return found == problem.boundary.end() ? nullptr : std::get_if<Kind>(&found->second);
}

/// Every fault of the problem that can be seen without solving it: sizes, names of parts, a condition
/// that holds the body, and every field evaluated on a coarse mesh of the domain. Empty if there is none.
std::vector<Fault> validate(const Problem& problem);

/// The same for the data of each variation of a sound problem; the faults of variation i have names under
/// `/sweep/i`.
std::vector<Fault> validate(const Problem& problem, const std::vector<Variation>& sweep);

}  // namespace signorini
