#pragma once

// What of each struct is stored, by the library cereal: one list of members serves writing and reading. It
// begins with a structured binding, so that it does not compile while a member is missing. A member that is
// added to a list ends it, under `if (version >= n)`, with n the new version of its class below, or that of
// the next larger one where its own has no version: results that an earlier version stored are still there.

#include <memory>

#include <cereal/types/array.hpp>
#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <cereal/types/vector.hpp>

#include "server/jobs/live_solve.hpp"

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
  auto& [name, edges] = part;
  archive(name, edges);
}

template <class Archive>
void serialize(Archive& archive, Circle& circle) {
  auto& [centre, radius] = circle;
  archive(centre, radius);
}

/// Its circles and its notes came later and end the list of a solution.
template <class Archive>
void serialize(Archive& archive, Mesh& mesh) {
  auto& [points, triangles, boundary, edges, triangle_edges, edge_triangles, circles, edge_circles, notes] =
      mesh;
  archive(points, triangles, boundary, edges, triangle_edges, edge_triangles);
}

template <class Archive>
void serialize(Archive& archive, ContactPart& part) {
  auto& [name, points, clearance, pressure, gap, weight, open] = part;
  archive(name, points, clearance, pressure, gap, weight, open);
}

/// The part of the edge came later and ends the list of a solution.
template <class Archive>
void serialize(Archive& archive, EdgePressure& pressure) {
  auto& [edge, at_ends, begin, end] = pressure;
  archive(edge, at_ends);
}

template <class Archive>
void serialize(Archive& archive, Iteration& iteration, std::uint32_t) {
  auto& [number, displacement_change, clearance_change, equilibrium, penetration, tension, complementarity,
         active, seconds] = iteration;
  archive(number, displacement_change, clearance_change, equilibrium, penetration, tension, complementarity,
          active, seconds);
}

template <class Archive>
void serialize(Archive& archive, Residuals& residuals) {
  auto& [equilibrium, constitutive, penetration, tension, complementarity, symmetry] = residuals;
  archive(equilibrium, constitutive, penetration, tension, complementarity, symmetry);
}

template <class Archive>
void serialize(Archive& archive, Unknowns& unknowns) {
  auto& [stress, displacement, contact, rotation] = unknowns;
  archive(stress, displacement, contact, rotation);
}

template <class Archive>
void serialize(Archive& archive, ContactSummary& contact) {
  auto& [force, max_pressure, length] = contact;
  archive(force, max_pressure, length);
}

template <class Archive>
void serialize(Archive& archive, Reaction& reaction) {
  auto& [part, force, moment] = reaction;
  archive(part, force, moment);
}

template <class Archive>
void serialize(Archive& archive, EnclosedNumber& number) {
  auto& [value, estimate, lower, upper] = number;
  archive(value, estimate, lower, upper);
}

template <class Archive>
void serialize(Archive& archive, CertifiedStretch& stretch) {
  auto& [begin, end, touches, carries_at_most, opens_at_most] = stretch;
  archive(begin, end, touches, carries_at_most, opens_at_most);
}

template <class Archive>
void serialize(Archive& archive, CertifiedSupport& support) {
  auto& [parts, force, moment, pressure_force, stretches] = support;
  archive(parts, force, moment, pressure_force, stretches);
}

template <class Archive>
void serialize(Archive& archive, Certified& certified) {
  auto& [energy, work, supports, unmet] = certified;
  archive(energy, work, supports, unmet);
}

/// The asymmetry came later and ends the lists that hold a bound.
template <class Archive>
void serialize(Archive& archive, ErrorBound::Parts& parts) {
  auto& [constitutive, contact, oscillation, equilibration, asymmetry] = parts;
  archive(constitutive, contact, oscillation, equilibration);
}

/// Without the work of the loads, which is among the certified numbers.
template <class Archive>
void serialize(Archive& archive, ErrorBound& bound) {
  auto& [value, relative, guaranteed, unmet, energy_lower, energy_upper, work, parts] = bound;
  archive(value, relative, guaranteed, unmet, energy_lower, energy_upper, parts);
}

template <class Archive>
void serialize_asymmetry(Archive& archive, std::optional<ErrorBound>& bound) {
  if (bound) archive(bound->parts.asymmetry);
}

/// The seconds of the certificate came later and end the list of a summary.
template <class Archive>
void serialize(Archive& archive, Timings& timings) {
  auto& [mesh, assemble, factorize, iterate, certify, total] = timings;
  archive(mesh, assemble, factorize, iterate, total);
}

/// Without the shares of triangles, which only a mesh that refines itself asks for.
template <class Archive>
void serialize(Archive& archive, EnclosedQuantity& quantity) {
  auto& [name, value, estimate, lower, upper, guaranteed, unmet, shares] = quantity;
  archive(name, value, estimate, lower, upper, guaranteed, unmet);
}

template <class Archive>
void serialize(Archive& archive, Level& level) {
  auto& [number, triangles, unknowns, bound, relative, iterations, seconds] = level;
  archive(number, triangles, unknowns, bound, relative, iterations, seconds);
}

template <class Archive>
void serialize(Archive& archive, Summary& summary, std::uint32_t version) {
  auto& [outcome, advice, notes, method, iterations, triangles, unknowns, energy, residuals, contact,
         error_bound, parts, quantities, certified, levels, reused, timings, peak_memory_bytes] = summary;
  archive(outcome, advice, method, iterations, triangles, unknowns, energy, residuals, contact, parts,
          timings, peak_memory_bytes, reused, error_bound);
  if (version >= 1) archive(levels, timings.certify);
  if (version >= 2) serialize_asymmetry(archive, error_bound);
  if (version >= 3) archive(notes);
  if (version >= 4) archive(quantities);
  if (version >= 5) archive(certified);
}

/// The bound and the quantities came later and end the list of a solution.
template <class Archive>
void serialize(Archive& archive, SweepEntry& entry) {
  auto& [title, error, outcome, advice, iterations, energy, penetration, tension, complementarity, sums,
         parts, seconds, contact, error_bound, quantities] = entry;
  archive(title, error, outcome, advice, iterations, energy, penetration, tension, complementarity, sums,
          parts, seconds, contact);
}

template <class Archive>
void serialize(Archive& archive, TrueErrors& errors) {
  auto& [displacement, stress, energy_norm, energy, total] = errors;
  archive(displacement, stress, energy_norm, energy, total);
}

/// The quantities and the inf-sup constant came later and end the list of a solution.
template <class Archive>
void serialize(Archive& archive, StudyRow& row) {
  auto& [scheme, error, level, size, triangles, unknowns, energy, error_bound, quantities, errors, inf_sup,
         iterations, seconds] = row;
  archive(scheme, error, level, size, triangles, unknowns, energy, error_bound, errors, iterations, seconds);
}

template <class Archive>
void serialize(Archive& archive, LevelFields& level) {
  auto& [number, points, triangles, displacement_at_points, error_squares] = level;
  archive(number, points, triangles, displacement_at_points, error_squares);
}

template <class Archive>
void serialize(Archive& archive, Solution& solution, std::uint32_t version) {
  auto& [summary, scheme, shared_mesh, components, stress, displacement, rotation, displacement_at_points,
         stress_at_centroids, out_of_plane_stress, error_squares, admissible_pressure, contact, history,
         sweep, study, levels] = solution;
  // The one that is written stays as it is.
  const auto mesh =
      Archive::is_loading::value ? std::make_shared<Mesh>() : std::const_pointer_cast<Mesh>(shared_mesh);
  archive(summary, scheme, *mesh, components, stress, displacement, rotation, displacement_at_points,
          stress_at_centroids, out_of_plane_stress, contact, history);
  if (version >= 1) archive(sweep);
  if (version >= 2) archive(study);
  if (version >= 3)
    for (StudyRow& row : study) serialize_asymmetry(archive, row.error_bound);
  if (version >= 4)
    archive(mesh->circles, mesh->edge_circles, mesh->notes, error_squares, admissible_pressure);
  if (version >= 5)
    for (EdgePressure& own : admissible_pressure) archive(own.begin, own.end);
  if (version >= 6) {
    for (SweepEntry& entry : sweep) {
      archive(entry.error_bound);
      serialize_asymmetry(archive, entry.error_bound);
    }
    archive(levels);
  }
  if (version >= 7) {
    for (SweepEntry& entry : sweep) archive(entry.quantities);
    for (StudyRow& row : study) archive(row.quantities);
  }
  if (version >= 8)
    for (StudyRow& row : study) archive(row.inf_sup);
  if constexpr (Archive::is_loading::value) shared_mesh = mesh;
}

}  // namespace signorini

namespace signorini::server {

template <class Archive>
void serialize(Archive& archive, FaultItem& item) {
  auto& [key, where, detail] = item;
  archive(key, where, detail);
}

template <class Archive>
void serialize(Archive& archive, ProblemDetails& details) {
  archive(details.kind, details.title, details.detail, details.errors);
}

template <class Archive>
void serialize(Archive& archive, Verdict& verdict) {
  auto& [error, summary, last_iteration] = verdict;
  archive(error, summary, last_iteration);
}

template <class Archive>
void serialize(Archive& archive, Progress& progress) {
  auto& [phase, iteration, residual, level, swept, sweep, studied, study] = progress;
  archive(phase, iteration, residual, level, swept, sweep, studied, study);
}

}  // namespace signorini::server

CEREAL_CLASS_VERSION(signorini::Iteration, 0)
CEREAL_CLASS_VERSION(signorini::Summary, 5)
CEREAL_CLASS_VERSION(signorini::Solution, 8)
