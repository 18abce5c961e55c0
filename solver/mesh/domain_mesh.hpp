#pragma once

#include <cstdint>
#include <optional>

#include "mesh/mesh.hpp"
#include "problem/domain.hpp"

namespace signorini {

class Progress;

/// The names of the boundary parts of a domain, in the order in which its mesh has them.
std::vector<std::string> part_names(const Domain& domain);

/// Every fault of the domain and of the mesh it is asked for, with pointers below /domain and /mesh. What
/// only the making of a large mesh shows, or more than few pairs of its edges, make_domain_mesh() tells.
std::vector<Fault> validate(const Domain& domain, const MeshRequest& request);

/// The same of the mesh alone, for a domain without a fault.
std::vector<Fault> validate_request(const Domain& domain, const MeshRequest& request);

/// Meshes of so many triangles are made to answer a question about a problem: in some hundredths of a second,
/// and a few megabytes.
inline constexpr std::int64_t few_triangles = 4000;

/// Whether the domain brings a mesh of more than `few_triangles`. The edges of its boundary count as well,
/// for so do its bodies and parts, each of which is looked at by itself.
bool brings_large_mesh(const Domain& domain);

/// An edge length that shows the shape of a rectangle or polygon and little more.
LargestEdge coarse_edge(const Domain& domain);

/// The mesh of a domain that has no fault, with its uniform refinements. Throws InvalidProblem for faults
/// that only the making shows, and what a Progress throws, if there is one.
Mesh make_domain_mesh(const Domain& domain, const MeshRequest& request, Progress* progress = nullptr);

/// The same without the refinements if it has at most about so many triangles, else nothing.
std::optional<Mesh> make_small_mesh(const Domain& domain, const MeshRequest& request,
                                    std::int64_t most = few_triangles);

/// A mesh on which the data of a problem can be tried out; nothing if even a coarse one has more than few
/// triangles.
std::optional<Mesh> make_coarse_mesh(const Domain& domain);

}  // namespace signorini
