#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "formula/formula.hpp"

namespace signorini {

using Point = Eigen::Vector2d;
using Vector = Eigen::Vector2d;

/// One thing that is wrong with a problem: where it stands (the path of the member, written as a JSON
/// pointer, e.g. `/boundary/top/gap`) and what is wrong and what would be right, in words.
struct Fault {
  std::string where;
  std::string detail;
};

/// A problem that cannot be solved as posed. Carries every fault that was found.
class InvalidProblem : public std::runtime_error {
 public:
  explicit InvalidProblem(std::vector<Fault> faults);

  const std::vector<Fault>& faults() const { return faults_; }

 private:
  std::vector<Fault> faults_;
};

/// A scalar that may vary in space, and on a boundary with the outward unit normal: a coefficient, a
/// load or boundary data, in the units of the problem.
///
/// A field knows its name (the path of the member that it came from), so that a value that is not finite
/// is refused with the name and the place. Of a formula the certificate encloses all values; of a function it
/// knows only those that it asks for, so that nothing is guaranteed, unless the function says that it is
/// quadratic.
class Field {
 public:
  using Function = std::function<double(const Point& x, const Vector& normal)>;

  Field(double constant = 0, std::string name = {});
  Field(Formula formula, std::string name);
  Field(Function function, std::string name);

  /// A function that is quadratic along every edge on which it is a boundary value.
  static Field quadratic_on_edges(Function function, std::string name);

  /// The value at x; inside the domain there is no normal. Throws InvalidProblem if it is not finite.
  double operator()(const Point& x, const Vector& normal = Vector::Zero()) const {
    if (formula_) return checked((*formula_)(x.x(), x.y(), normal.x(), normal.y()), x);
    return function_ ? checked(function_(x, normal), x) : constant_;
  }

  /// This field plus a number times another, under the name of this one. Of formulas and constants it is one
  /// again.
  Field plus(double factor, const Field& other) const;

  bool is_constant() const { return !function_ && !formula_; }
  bool is_quadratic_on_edges() const { return quadratic_on_edges_; }
  /// Null if there is none.
  const Formula* formula() const { return formula_.get(); }
  const std::string& name() const { return name_; }

 private:
  double checked(double value, const Point& x) const;
  Formula as_formula() const;

  double constant_ = 0;
  std::shared_ptr<const Formula> formula_;
  Function function_;
  bool quadratic_on_edges_ = false;
  std::string name_;
};

/// A displacement, load or traction: one component for a membrane, two (x, y) for an elastic body. Without
/// components it is zero.
class VectorField {
 public:
  VectorField() = default;
  VectorField(Field scalar) : components_{std::move(scalar)} {}
  VectorField(double scalar) : VectorField(Field(scalar)) {}
  VectorField(Field x, Field y) : components_{std::move(x), std::move(y)} {}

  double operator()(int component, const Point& x, const Vector& normal = Vector::Zero()) const {
    return components_.empty() ? 0 : components_[component](x, normal);
  }

  int size() const { return static_cast<int>(components_.size()); }
  const std::vector<Field>& fields() const { return components_; }

 private:
  std::vector<Field> components_;
};

/// Why nothing is guaranteed with a formula that has a pole near x, or may have one for all that its
/// enclosures tell, and what would help.
std::string not_known_to_be_finite(const Field& field, const Point& x);

/// `(x, y)` with the fewest digits that tell the point from its neighbours.
std::string to_string(const Point& x);

}  // namespace signorini
