#pragma once

// What of each struct is stored, by the library cereal: one list of members serves writing and reading. A
// member that is added to a list ends it, under `if (version >= n)`, with n the new version of its class
// below: results that an earlier version stored are still there.

#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>

#include "server/jobs/job.hpp"

namespace cereal {

/// The sizes that the type leaves open, then the coefficients.
template <class Archive, int Rows, int Columns>
void save(Archive& archive, const Eigen::Matrix<double, Rows, Columns>& matrix) {
  if constexpr (Rows == Eigen::Dynamic) archive(std::int64_t{matrix.rows()});
  if constexpr (Columns == Eigen::Dynamic) archive(std::int64_t{matrix.cols()});
  archive(binary_data(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double)));
}

template <class Archive, int Rows, int Columns>
void load(Archive& archive, Eigen::Matrix<double, Rows, Columns>& matrix) {
  std::int64_t rows = Rows;
  std::int64_t columns = Columns;
  if constexpr (Rows == Eigen::Dynamic) archive(rows);
  if constexpr (Columns == Eigen::Dynamic) archive(columns);
  matrix.resize(rows, columns);
  archive(binary_data(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(double)));
}

}  // namespace cereal

namespace signorini {

template <class Archive>
void serialize(Archive& archive, BoundaryPart& part) {
  archive(part.name, part.edges);
}

template <class Archive>
void serialize(Archive& archive, Mesh& mesh) {
  archive(mesh.points, mesh.triangles, mesh.boundary, mesh.edges, mesh.triangle_edges, mesh.edge_triangles);
}

template <class Archive>
void serialize(Archive& archive, ContactPart& part) {
  archive(part.name, part.points, part.clearance, part.pressure, part.gap, part.weight, part.open);
}

template <class Archive>
void serialize(Archive& archive, Iteration& iteration, std::uint32_t) {
  archive(iteration.number, iteration.displacement_change, iteration.clearance_change, iteration.equilibrium,
          iteration.penetration, iteration.tension, iteration.complementarity, iteration.active,
          iteration.seconds);
}

template <class Archive>
void serialize(Archive& archive, Residuals& residuals) {
  archive(residuals.equilibrium, residuals.constitutive, residuals.penetration, residuals.tension,
          residuals.complementarity, residuals.symmetry);
}

template <class Archive>
void serialize(Archive& archive, Unknowns& unknowns) {
  archive(unknowns.stress, unknowns.displacement, unknowns.contact, unknowns.rotation);
}

template <class Archive>
void serialize(Archive& archive, ContactSummary& contact) {
  archive(contact.force, contact.max_pressure, contact.length);
}

template <class Archive>
void serialize(Archive& archive, Reaction& reaction) {
  archive(reaction.part, reaction.force, reaction.moment);
}

template <class Archive>
void serialize(Archive& archive, ErrorBound::Parts& parts) {
  archive(parts.constitutive, parts.contact, parts.oscillation, parts.equilibration);
}

template <class Archive>
void serialize(Archive& archive, ErrorBound& bound) {
  archive(bound.value, bound.relative, bound.guaranteed, bound.unmet, bound.energy_lower, bound.energy_upper,
          bound.parts);
}

/// What came to the parts later; it ends the lists that hold a bound.
template <class Archive>
void serialize_asymmetry(Archive& archive, std::optional<ErrorBound>& bound) {
  if (bound) archive(bound->parts.asymmetry);
}

template <class Archive>
void serialize(Archive& archive, Timings& timings) {
  archive(timings.mesh, timings.assemble, timings.factorize, timings.iterate, timings.total);
}

template <class Archive>
void serialize(Archive& archive, Level& level) {
  archive(level.number, level.triangles, level.unknowns, level.bound, level.relative, level.iterations,
          level.seconds);
}

template <class Archive>
void serialize(Archive& archive, Summary& summary, std::uint32_t version) {
  archive(summary.outcome, summary.advice, summary.method, summary.iterations, summary.triangles,
          summary.unknowns, summary.energy, summary.residuals, summary.contact, summary.parts,
          summary.timings, summary.peak_memory_bytes, summary.reused, summary.error_bound);
  if (version >= 1) archive(summary.levels, summary.timings.certify);
  if (version >= 2) serialize_asymmetry(archive, summary.error_bound);
}

template <class Archive>
void serialize(Archive& archive, SweepEntry& entry) {
  archive(entry.title, entry.error, entry.outcome, entry.advice, entry.iterations, entry.energy,
          entry.penetration, entry.tension, entry.complementarity, entry.sums, entry.parts, entry.seconds,
          entry.contact);
}

template <class Archive>
void serialize(Archive& archive, TrueErrors& errors) {
  archive(errors.displacement, errors.stress, errors.energy_norm, errors.energy, errors.total);
}

template <class Archive>
void serialize(Archive& archive, StudyRow& row) {
  archive(row.scheme, row.error, row.level, row.size, row.triangles, row.unknowns, row.energy,
          row.error_bound, row.errors, row.iterations, row.seconds);
}

template <class Archive>
void serialize(Archive& archive, Solution& solution, std::uint32_t version) {
  archive(solution.summary, solution.scheme, solution.mesh, solution.components, solution.stress,
          solution.displacement, solution.rotation, solution.displacement_at_points,
          solution.stress_at_centroids, solution.out_of_plane_stress, solution.contact, solution.history);
  if (version >= 1) archive(solution.sweep);
  if (version >= 2) archive(solution.study);
  if (version >= 3)
    for (StudyRow& row : solution.study) serialize_asymmetry(archive, row.error_bound);
}

}  // namespace signorini

namespace signorini::server {

template <class Archive>
void serialize(Archive& archive, FaultItem& item) {
  archive(item.key, item.where, item.detail);
}

template <class Archive>
void serialize(Archive& archive, ProblemDetails& details) {
  archive(details.kind, details.title, details.detail, details.errors);
}

template <class Archive>
void serialize(Archive& archive, Verdict& verdict) {
  archive(verdict.error, verdict.summary, verdict.last_iteration);
}

}  // namespace signorini::server

CEREAL_CLASS_VERSION(signorini::Iteration, 0)
CEREAL_CLASS_VERSION(signorini::Summary, 2)
CEREAL_CLASS_VERSION(signorini::Solution, 3)
