#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "problem/field.hpp"

namespace signorini {

struct Problem;

/// A motion of a support: x ↦ translation + rotation · (−y, x) of an elastic body; of a membrane the first
/// component of the translation.
struct SupportMotion {
  Vector translation = Vector::Zero();
  double rotation = 0;

  Vector operator()(const Point& x) const { return translation + rotation * Vector(-x.y(), x.x()); }
};

/// A disc in the body, over which a mean is taken.
struct Disc {
  Point centre{0, 0};
  double radius = 0;
  std::string name;  ///< the path of the member that it came from
};

/// A polygon in the body, over which a mean is taken; no two of its sides cross.
struct Outline {
  std::vector<Point> corners;
  std::string name;  ///< the path of the member that it came from
};

/// A number that is linear in the solution and that the certificate encloses:
///
///     Q = <p, w> + (q, u) + <r, u> + Σ ∫ ρ·σn,
///
/// with weights w on contact parts, densities q in the domain and r on parts of Γ_F, and motions ρ of parts
/// that are fixed or on rollers, where σn is what acts on the body. They are the data of
/// dual_problem(), and −Q is how the least energy changes along them (certify/THEORY.md, section 9). Or Q = ∫
/// w λ tells how far a contact is open.
struct Quantity {
  std::string name;
  std::map<std::string, Field> weights;          ///< w, by parts
  VectorField density;                           ///< q
  std::map<std::string, VectorField> densities;  ///< r, by parts
  std::map<std::string, SupportMotion> motions;  ///< ρ, by parts
  bool is_mean = false;                          ///< it is divided by the length of the parts with a density
  /// In which alone q is not 0; it must lie in the domain.
  std::optional<Disc> disc;
  std::optional<Outline> outline;
  std::map<std::string, Field> openings;  ///< w of ∫ w λ, by parts; then there is nothing else

  /// Its dual problem has no loads.
  bool has_no_loads() const { return density.size() == 0 && densities.empty(); }
};

/// The problem with the gaps w, the load q, the tractions r, the fixed values −ρ and the rollers moved by −ρ,
/// and 0 where the quantity names nothing: what the data of the problem are changed by along the quantity.
/// Its operator is the same.
Problem dual_problem(const Problem& problem, const Quantity& quantity);

}  // namespace signorini
