#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

constexpr std::string_view matrix_shape = "a symmetric 2x2 matrix, [[xx, xy], [xy, yy]]";
constexpr std::string_view tensor_shape =
    "a symmetric 3x3 matrix in the order xx, yy, xy, with engineering shear strain";

/// A field that must be positive; a constant is checked here, an expression where it is evaluated.
Field read_positive(const Value& value) {
  const auto field = read_field(value, Variables::interior);
  if (!field) return Field(1);
  if (field->is_constant() && !((*field)(Point::Zero()) > 0)) value.unexpected("positive");
  return *field;
}

/// The upper triangle of a symmetric matrix of fields, row by row; nothing if it is none.
std::optional<std::vector<Field>> read_symmetric(const Value& value, std::size_t size,
                                                 std::string_view shape) {
  const auto rows = value.elements(size, shape);
  if (!rows) return std::nullopt;
  std::vector<std::vector<Value>> entries;
  for (const Value& row : *rows) {
    const auto of_row = row.elements(size, "a row of " + std::to_string(size) + " entries");
    if (of_row) entries.push_back(*of_row);
  }
  if (entries.size() < size) return std::nullopt;
  std::vector<Field> upper;
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = i; j < size; ++j) {
      upper.push_back(read_field(entries[i][j], Variables::interior).value_or(Field()));
      if (entries[i][j].json() != entries[j][i].json())
        entries[j][i].fault("differs from the entry across the diagonal; must be " + std::string(shape));
    }
  return upper;
}

MembraneStiffness read_stiffness(const Value& value) {
  if (!value.json().is_array()) return MembraneStiffness::isotropic(read_positive(value));
  const auto upper = read_symmetric(value, 2, matrix_shape);
  return upper ? MembraneStiffness{(*upper)[0], (*upper)[1], (*upper)[2]} : MembraneStiffness{};
}

Material read_membrane(const Object& object) {
  object.allow({"stiffness"}, "the material of a membrane");
  const auto stiffness =
      object.require("stiffness", "kappa, a number, an expression or " + std::string(matrix_shape));
  return stiffness ? read_stiffness(*stiffness) : MembraneStiffness{};
}

Field read_poisson(const Value& value) {
  const auto field = read_field(value, Variables::interior);
  if (!field) return Field();
  const bool constant = field->is_constant();
  const double ratio = constant ? (*field)(Point::Zero()) : 0;
  if (!(ratio > -1 && ratio < 0.5)) value.unexpected("greater than -1 and less than 1/2");
  return *field;
}

Material read_tensor(const Value& value) {
  HookeTensor tensor;
  if (const auto upper = read_symmetric(value, 3, tensor_shape))
    std::ranges::copy(*upper, tensor.entries.begin());
  return tensor;
}

Material read_elastic(const Value& value, const Object& object) {
  object.allow({"young", "poisson", "plane", "tensor"}, "the material of an elastic body");
  const auto tensor = object.find("tensor");
  if (!tensor) {
    YoungPoisson material;
    if (const auto young = object.require("young", "Young's modulus (or give tensor)"))
      material.young = read_positive(*young);
    if (const auto poisson = object.require("poisson", "Poisson's ratio (or give tensor)"))
      material.poisson = read_poisson(*poisson);
    if (const auto plane = object.find("plane"))
      material.plane = plane->one_of(plane_names).value_or(material.plane);
    return material;
  }
  if (object.find("young") || object.find("poisson") || object.find("plane"))
    value.fault("must have either tensor, or young and poisson (with plane); not both");
  return read_tensor(*tensor);
}

}  // namespace

Material read_material(const Value& value, Model model) {
  const auto object = value.object();
  if (!object) return MembraneStiffness{};
  return model == Model::membrane ? read_membrane(*object) : read_elastic(value, *object);
}

VectorField read_load(const Value& value, Model model) {
  const auto object = value.object();
  if (!object) return {};
  object->allow({"body"}, "the load");
  const auto body = object->find("body");
  return body ? read_vector_field(*body, model, Variables::interior).value_or(VectorField()) : VectorField();
}

}  // namespace signorini::api
