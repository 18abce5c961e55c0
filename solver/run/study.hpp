#pragma once

#include <functional>

#include "problem/study.hpp"
#include "result/solution.hpp"

namespace signorini {

/// Solves the problem on every mesh by every scheme, scheme by scheme in the order of the meshes: a row a
/// mesh, or a row a level of one that refines itself. No operator is kept or reused, so that the seconds of
/// the rows compare.
///
/// A run that cannot be solved gives a row that says why and does not end the others. The time limit is for
/// the whole. Throws Cancelled.
std::vector<StudyRow> run_study(const Problem& problem, const Study& study, const Settings& settings,
                                Observer& observer);

/// A column of a study's table: its number in a row, if there is one.
using RowNumber = std::function<std::optional<double>(const StudyRow&)>;

/// The exponent α for which the number is proportional to n^(−α/2), with n triangles, between the row and
/// the one of its scheme before it that has one. Where all edges are halved that is h^α. None where
/// one of both is zero.
std::optional<double> observed_rate(const std::vector<StudyRow>& rows, std::size_t row,
                                    const RowNumber& number);

/// The same by least squares over all rows of the scheme.
std::optional<double> fitted_rate(const std::vector<StudyRow>& rows, Scheme scheme, const RowNumber& number);

}  // namespace signorini
