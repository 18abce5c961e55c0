#pragma once

#include <functional>
#include <vector>

#include "api/document/document_writer.hpp"
#include "result/solution.hpp"

/// The members of a result document (api/README.md, "A result"), each written by one function as a value.
namespace signorini::api {

void write_summary(DocumentWriter& out, const Summary& summary);
void write_unknowns(DocumentWriter& out, const Unknowns& unknowns);
void write_mesh(DocumentWriter& out, const Mesh& mesh);
void write_displacement(DocumentWriter& out, const Solution& solution);
void write_stress(DocumentWriter& out, const Solution& solution);
/// [σ₁, σ₂] at the centroid of each triangle, in the plane, σ₁ ≥ σ₂; of an elastic body.
void write_principal(DocumentWriter& out, const Solution& solution);
/// Von Mises' stress at the centroid of each triangle, with the σ_zz of the solution; of an elastic body.
void write_von_mises(DocumentWriter& out, const Solution& solution);
/// What each triangle adds to the square of the error bound.
void write_error_squares(DocumentWriter& out, const Solution& solution);
/// What is seen of the levels of a mesh that refined itself.
void write_level_fields(DocumentWriter& out, const std::vector<LevelFields>& levels);
void write_contact(DocumentWriter& out, const std::vector<ContactPart>& parts);
void write_quantities(DocumentWriter& out, const std::vector<EnclosedQuantity>& quantities);
/// `with_contact`: clearances and pressures of every entry too.
void write_sweep(DocumentWriter& out, const std::vector<SweepEntry>& sweep, bool with_contact);
/// The rows of study_columns.hpp, and the fitted rates of each scheme.
void write_study(DocumentWriter& out, const std::vector<StudyRow>& rows);
/// Iterations by their places; valid until the next one is asked for.
using HistoryRow = std::function<const Iteration&(std::size_t)>;
void write_history(DocumentWriter& out, std::size_t rows, const HistoryRow& row);
void write_history(DocumentWriter& out, const std::vector<Iteration>& history);
/// One row of it.
void write_iteration(DocumentWriter& out, const Iteration& iteration);

}  // namespace signorini::api
