#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "certify/data/law_quality.hpp"
#include "fem/triangle_pieces.hpp"
#include "mesh/mesh.hpp"
#include "problem/material.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// A part of a triangle, and how well the law is known on it.
struct LawPiece : LawQuality {
  TrianglePiece place;
  bool jumps = false;  ///< or has a kink, or may have one

  bool is_known() const { return std::isfinite(errors.back() + softest + stiffest); }

  /// The degree of the cheapest rule for squares of fields of a degree that is off by no more than the
  /// tolerance, or hardly more than the best.
  int degree_of_rule(int of_fields, double tolerance) const;

  /// Of a rule that is exact for one degree, where fields of another degree are squared.
  double error_of_rule(int degree, int of_fields) const {
    return errors[std::clamp(degree - 2 * of_fields + 1, 0, kOrders - 1)];
  }
};

/// For the errors of the highest order.
struct LawTolerance {
  double smooth, of_jumps;
};

/// Cuts a triangle for the fields of the material; a constant one is a single piece without error.
std::vector<LawPiece> law_pieces(const Material& material, const std::array<Point, 3>& corners,
                                 const LawTolerance& tolerance, CellBudget& budget);

/// The law of a problem on all triangles of its mesh, which must outlive it. The pieces of a triangle are
/// found again whenever they are asked for: hardly any work beside the integrals over them, but more memory
/// than the factor if they were kept.
class LawOnMesh {
 public:
  /// `tolerance`: what the integrals of squares may be off by, relative.
  LawOnMesh(const Material& material, const Mesh& mesh, double tolerance, Progress& progress);

  double tolerance() const { return tolerance_; }

  /// Of the whole triangle if it is a single piece, else the largest of its pieces.
  const LawPiece& whole(int t) const { return whole_[whole_.size() == 1 ? 0 : t]; }
  /// The pieces of a triangle that is cut; none of one that is not.
  std::vector<LawPiece> cut(int t) const;
  /// Why what it says is not certain; empty if it is.
  const std::vector<std::string>& unmet() const { return unmet_; }

 private:
  const Material& material_;
  const Mesh& mesh_;
  Progress& progress_;
  double tolerance_;
  std::vector<LawPiece> whole_;
  std::unordered_map<int, LawTolerance> tolerances_;  ///< of triangles that are cut
  std::vector<std::string> unmet_;
};

}  // namespace signorini
