#pragma once

#include <cstddef>

#include "mesh/polygon.hpp"

/// How many of everything a problem may have, so that reading one takes a tenth of a second and a few
/// megabytes at most; only a mesh of the client's own is larger. The OpenAPI document says the same.
namespace signorini::api::limits {

// Of a document: arrays and objects within each other, values, and members of objects.
inline constexpr std::size_t nesting = 64, values = 2'000'000, members = 200'000;
/// Of them, values that are not in the mesh of a domain.
inline constexpr std::size_t values_beside_mesh = 300'000;
/// What the values may take, in bytes: so many, and so many for each byte of the document.
inline constexpr std::size_t memory = 8'000'000, memory_of_byte = 10;
/// Of a number, one after the other: a double is known by a few, and a million take as long as a thousand
/// numbers.
inline constexpr std::size_t digits = 1000;

// Characters.
inline constexpr std::size_t title = 200, part_name = 200, expression = 1000, tag = 50;
/// Of all titles and expressions together.
inline constexpr std::size_t texts = 1'000'000;

inline constexpr std::size_t vertices = most_vertices, arcs = most_arcs, holes = most_holes,
                             local_sizes = most_local_sizes;
inline constexpr std::size_t tags = 16;
inline constexpr std::size_t quantities = 100;
/// Of the polygon that a quantity is a mean over.
inline constexpr std::size_t outline_corners = 32;
/// Of the boundary, each of which may have a condition.
inline constexpr std::size_t parts = vertices + holes;

inline constexpr int divisions = 10'000, refinements = 12, triangles = most_triangles, iterations = 1'000'000;

inline constexpr std::size_t sweep_entries = 10'000, study_meshes = 64, batch_problems = 1000;
/// Of all entries of a sweep together, with those that an entry has from the problem.
inline constexpr std::size_t sweep_conditions = 50'000;
/// Of a mesh, and of all meshes of a study together, local sizes times sides of the polygon.
inline constexpr std::size_t mesh_local_sizes = 1'000'000, study_local_sizes = 200'000;

}  // namespace signorini::api::limits
