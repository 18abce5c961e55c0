#include "certify/elasticity/shape_norms.hpp"

namespace signorini {
namespace {

/// As many triangles as can be summed up point by point in the time that the operators of a shape take.
constexpr int kOften = 60;

}  // namespace

void ShapeNorms::look_over(const Discretization& discrete) {
  if (shapes_ || !discrete.element.has_constant_material()) return;
  const Mesh& mesh = discrete.mesh;
  shapes_.emplace(AffineMap(mesh.corners(0)));
  for (int t = 0; t < discrete.triangles(); ++t)
    ++(*shapes_)(AffineMap(mesh.corners(t)).jacobian, [] { return Shape(); }).triangles;
  shapes_->forget_if([](const Shape& shape) { return shape.triangles < kOften; });
}

const JohnsonMercierNorms* ShapeNorms::operator()(const AffineMap& map, const Spaces& spaces,
                                                  LawField<2>& law) {
  Shape* const shape = shape_of(map);
  if (shape == nullptr) return nullptr;
  if (!shape->norms)
    shape->norms = std::make_unique<const JohnsonMercierNorms>(johnson_mercier_rule(spaces, 6), map,
                                                               SymmetricLaw(law(map({0, 0})).compliance));
  return shape->norms.get();
}

const JohnsonMercierNorms* ShapeNorms::made(const AffineMap& map) {
  const Shape* const shape = shape_of(map);
  return shape != nullptr ? shape->norms.get() : nullptr;
}

}  // namespace signorini
