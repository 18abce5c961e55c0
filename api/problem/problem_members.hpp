#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "api/names.hpp"
#include "api/problem/expression.hpp"
#include "api/problem/reader.hpp"
#include "problem/problem.hpp"
#include "problem/settings.hpp"
#include "problem/study.hpp"

/// The members of a problem document (api/README.md, "A problem"), each read by one function. All add their
/// faults to those of the value; what they answer then is of no use.
namespace signorini::api {

/// A number, or an expression in a string.
std::optional<Field> read_field(const Value& value, Variables variables);

/// A displacement, load or traction of the model: a field for a membrane, a pair of them for an elastic body.
std::optional<VectorField> read_vector_field(const Value& value, Model model, Variables variables);

/// Two numbers, both positive if asked; `expected` describes them.
std::optional<Eigen::Vector2d> read_pair(const Value& value, std::string_view expected, bool positive);

Domain read_domain(const Value& value);

/// The domain decides which members there are, and how many triangles a `size` means.
MeshRequest read_mesh(const Value& value, const Domain& domain);

Material read_material(const Value& value, Model model);

/// The body load.
VectorField read_load(const Value& value, Model model);

/// The name under which a boundary has the condition of every part that it does not name.
inline constexpr std::string_view every_other_part = "all";

/// The conditions by the names that they stand under.
std::map<std::string, Condition> read_conditions(const Value& value, Model model);

/// The conditions by part of the domain; `all` is resolved to the parts that are not named.
std::map<std::string, Condition> read_boundary(const Value& value, Model model, const Domain& domain);

/// What is asked for; the problem is what was read of the document so far.
std::vector<Quantity> read_quantities(const Value& value, Model model, const Problem& problem);

Settings read_settings(const Value& value);

std::string read_title(const Value& value);

/// Tags, no two of which are the same.
std::vector<std::string> read_tags(const Value& value);

/// What is wrong with a text as a tag; nothing if nothing is.
std::optional<std::string> fault_of_tag(const std::string& text);

/// Merge patches (RFC 7396) of the document's load, material and boundary data; the problem is what was read
/// of it.
std::vector<Variation> read_sweep(const Value& value, const Object& document, const Problem& problem);

/// Its meshes are the document's with another fineness; the problem is what was read of it.
Study read_study(const Value& value, const Object& document, const Problem& problem);

}  // namespace signorini::api
