#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "problem/problem.hpp"
#include "problem/settings.hpp"

namespace signorini {

/// What is known of the exact solution of a problem, in its units.
struct Exact {
  std::optional<VectorField> displacement;
  std::vector<Field> stress;     ///< (σ_x, σ_y), or (σ_xx, σ_yy, σ_xy); empty: not known
  std::optional<double> energy;  ///< J(u) = ½(Cσ,σ) − (f,u) − <t,u>
};

/// A mesh of a study. Like a field it knows its name, the path of the member that it came from.
struct StudyMesh {
  std::string name;
  MeshRequest request;
};

/// A problem to be solved on several meshes by several schemes, to see how the error falls.
struct Study {
  std::vector<Scheme> schemes;
  std::vector<StudyMesh> meshes;
  Exact exact;
  bool checks_inf_sup = false;  ///< whether each row has the inf-sup constant of its spaces and mesh
};

/// The stress unknowns of the largest mesh whose inf-sup constant is computed: seconds and a gigabyte.
constexpr std::int64_t most_for_inf_sup = 300'000;

/// The problem on the mesh by the scheme.
Problem run_of(const Problem& problem, const StudyMesh& mesh, Scheme scheme);

/// Every fault of the study of a sound problem.
std::vector<Fault> validate(const Problem& problem, const Study& study, const Settings& settings);

}  // namespace signorini
