#pragma once

#include <array>
#include <vector>

#include "fem/triangle_pieces.hpp"
#include "problem/material.hpp"

namespace signorini {

/// How well stiffness E and compliance C are known on a cell: they differ from polynomials of degree k − 1 by
/// at most errors[k] times themselves, as quadratic forms (THEORY.md, "What is enclosed of a law").
struct LawQuality {
  static constexpr int kOrders = 11;

  std::array<double, kOrders> errors{};
  double softest = 0;   ///< C is at most this; infinite where E is not known to be positive definite
  double stiffest = 0;  ///< E is at most this
};

/// The fields of a material that are to be enclosed: one where all are multiples of it.
std::vector<const Field*> different_fields(const Material& material);

/// The different fields of a material on a cell.
struct EnclosedFields {
  std::vector<Series> series;    ///< none where something is not decided
  std::vector<Models> branches;  ///< see branches_on_triangle(); none where the series do
};

/// Empty where a jump or a kink may lie in the triangle: what lies beside it is known by branches only.
std::vector<Series> series_of(const std::vector<const Field*>& fields, const std::array<Point, 3>& corners);

LawQuality quality_of(const Material& material, const EnclosedFields& fields);

}  // namespace signorini
