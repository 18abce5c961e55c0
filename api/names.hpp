#pragma once

#include <algorithm>
#include <string_view>
#include <vector>

#include "problem/problem.hpp"

namespace signorini::api {

/// A value and the one name that it has in every document.
template <typename T>
struct Named {
  std::string_view name;
  T value;
};

template <typename T>
using Names = std::vector<Named<T>>;

/// The names of a table alone, for messages.
template <typename T>
std::vector<std::string_view> only_names(const Names<T>& table) {
  std::vector<std::string_view> names;
  for (const Named<T>& entry : table) names.push_back(entry.name);
  return names;
}

/// The name that a value of the table has.
template <typename T>
std::string_view name_in(const Names<T>& table, const T& value) {
  return std::ranges::find(table, value, &Named<T>::value)->name;
}

enum class Model { membrane, elasticity };
enum class DomainType { rectangle, polygon, mesh, gmsh };
enum class StudyCheck { inf_sup };
enum class MethodName { uzawa, active_set };

inline const Names<Model> model_names{{"membrane", Model::membrane}, {"elasticity", Model::elasticity}};
inline const Names<StudyCheck> study_check_names{{"inf_sup", StudyCheck::inf_sup}};
inline const Names<DomainType> domain_names{{"rectangle", DomainType::rectangle},
                                            {"polygon", DomainType::polygon},
                                            {"mesh", DomainType::mesh},
                                            {"gmsh", DomainType::gmsh}};
inline const Names<Plane> plane_names{{"strain", Plane::strain}, {"stress", Plane::stress}};
inline const Names<Pattern> pattern_names{{"right", Pattern::right},
                                          {"left", Pattern::left},
                                          {"alternating", Pattern::alternating},
                                          {"crossed", Pattern::crossed}};
inline const Names<Scheme> scheme_names{{"conforming", Scheme::conforming},
                                        {"nonconforming", Scheme::nonconforming}};
inline const Names<MethodName> method_names{{"uzawa", MethodName::uzawa},
                                            {"active_set", MethodName::active_set}};

}  // namespace signorini::api
