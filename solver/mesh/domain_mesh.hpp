#pragma once

#include "mesh/mesh.hpp"
#include "problem/domain.hpp"

namespace signorini {

/// The names of the boundary parts of a domain, in the order in which its mesh has them.
std::vector<std::string> part_names(const Domain& domain);

/// Every fault of the domain and of the mesh it is asked for, with pointers below /domain and /mesh.
std::vector<Fault> validate(const Domain& domain, const MeshRequest& request);

/// An edge length that shows the shape of a rectangle or polygon and little more.
LargestEdge coarse_edge(const Domain& domain);

/// The mesh of a domain that has no fault, with its uniform refinements. Throws InvalidProblem for faults
/// that only the making shows.
Mesh make_domain_mesh(const Domain& domain, const MeshRequest& request);

/// A mesh on which the data of a problem can be tried out without its full cost.
Mesh make_coarse_mesh(const Domain& domain);

}  // namespace signorini
