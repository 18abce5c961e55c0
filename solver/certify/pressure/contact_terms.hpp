#pragma once

#include "certify/displacement/admissible_displacement.hpp"
#include "certify/pressure/contact_pressure.hpp"
#include "fem/edge_pieces.hpp"

namespace signorini {

/// The integrals ∫ p (g − v_n) over edge i of the clearance space, for pressures and displacements of one or
/// of several pairs, with the same enclosure of g in all of them. Their radius is infinite where something
/// acts on a gap that is not known to be finite.
class ContactTerms {
 public:
  /// Of all edges together.
  static constexpr int kCells = 20'000;

  ContactTerms(const Discretization& discrete, const AdmissibleDisplacement& v, int i, CellBudget& budget);

  /// 2 ∫ p* (g − v_n) with the largest g, and no less than 0.
  double operator()(const ContactPressure& pressure, const AdmissibleDisplacement& v) const;

  /// ∫ p* (g − v_n) with the middle of g, and what that may be off by.
  struct Work {
    double value = 0, radius = 0;
  };
  Work work(const ContactPressure& pressure, const AdmissibleDisplacement& v) const;

  /// ∫ w (g − v_n), and what that may be off by.
  Work opening(const Field& weight, const AdmissibleDisplacement& v, CellBudget& budget) const;

 private:
  const Discretization& discrete_;
  const int edge_;
  const ContactEdge& contact_;
  const double length_;
  std::vector<EdgePiece> pieces_;
};

}  // namespace signorini
