#include "certify/shape_norms.hpp"

namespace signorini {
namespace {

/// As many triangles as can be summed up point by point in the time that the norms of a shape take.
constexpr int kOften = 60;

}  // namespace

void ShapeNorms::look_over(const Discretization& discrete) {
  if (shapes_ || !discrete.element.has_constant_material()) return;
  const Mesh& mesh = discrete.mesh;
  shapes_.emplace(AffineMap(mesh.corners(0)));
  for (int t = 0; t < discrete.triangles(); ++t) {
    const AffineMap map(mesh.corners(t));
    ++(*shapes_)(map.jacobian, [&map] { return Shape{map}; }).triangles;
  }
  shapes_->forget_if([](const Shape& shape) { return shape.triangles < kOften; });
}

const JohnsonMercierNorms* ShapeNorms::elastic(const AffineMap& map, const Spaces& spaces, LawField<2>& law) {
  Shape* const shape = shape_of(map);
  if (shape == nullptr) return nullptr;
  return shape->elastic.get_or(*makes_, [&] {
    return JohnsonMercierNorms(johnson_mercier_rule(spaces, 6), shape->map,
                               SymmetricLaw(law(map({0, 0})).compliance));
  });
}

const MembraneNorms* ShapeNorms::membrane(const AffineMap& map, const Spaces& spaces, LawField<1>& law) {
  Shape* const shape = shape_of(map);
  if (shape == nullptr) return nullptr;
  return shape->membrane.get_or(*makes_, [&] { return MembraneNorms(spaces, shape->map, law(map({0, 0}))); });
}

const JohnsonMercierNorms* ShapeNorms::made(const AffineMap& map) {
  const Shape* const shape = shape_of(map);
  return shape != nullptr ? shape->elastic.get() : nullptr;
}

}  // namespace signorini
