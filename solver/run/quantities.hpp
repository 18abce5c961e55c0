#pragma once

#include "certify/certificate.hpp"
#include "run/kept_duals.hpp"

namespace signorini {

/// Adds to a certificate what the problem asks for, if there is a bound, by the solutions of dual
/// problems with the operator at hand (certify/THEORY.md, section 9). `fields`, `solution`: of the condensed
/// problem; `by` factors the bodies that openings pull.
void enclose_quantities(const CondensedProblem& condensed, const Fields& fields, const Solution& solution,
                        Factorization by, Certificate& certificate, KeptDuals& kept, Progress& progress);

}  // namespace signorini
