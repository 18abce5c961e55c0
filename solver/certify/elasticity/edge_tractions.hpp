#pragma once

#include <span>
#include <string>
#include <vector>

#include "certify/pressure/contact_pressure.hpp"
#include "fem/discretization.hpp"
#include "fem/traction_field.hpp"
#include "progress/progress.hpp"

namespace signorini {

/// A linear traction at both ends and in the middle of an edge, by that at its ends.
inline Eigen::Matrix<double, 2, 3> linear_along_edge(const Eigen::Matrix2d& ends) {
  return (Eigen::Matrix<double, 2, 3>() << ends, ends.rowwise().mean()).finished();
}

/// Tractions on all edges of an elastic body, linear on each edge and quadratic on Γ_F, that hold every
/// triangle in equilibrium of forces and of moments under the discrete load, so that a symmetric stress with
/// these tractions exists.
///
/// They are those of σ_h and two changes, each the derivative along the edges of a stream function with two
/// components and so free of force: the one that turns the pressure into p* (an Airy function near Γ_C), and
/// one that spreads the asymmetry. as(σ_h) and the couples of the loads are orthogonal to every hat function
/// φ_z, therefore normal bubbles on the edges around z exist whose fluxes balance them in each triangle at z
/// (the flux equilibration of Braess and Schöberl 2008, applied to the rotation).
///
/// Into the body the Airy function is cubic along each edge, with a linear normal derivative (the reduced
/// element of Hsieh, Clough and Tocher): its traction is the derivative of w = (∂_y ψ, −∂_x ψ), w·n = ψ',
/// w·t = −∂_n ψ.
class EdgeTractions {
 public:
  /// Throws what Progress::check() throws.
  EdgeTractions(const Discretization& discrete, const Eigen::MatrixXd& stress,
                const ContactPressure& pressure, Progress& progress);

  /// The traction on a triangle's local edge e from outside, per length: column 0 at corner e + 1, column 1
  /// at corner e + 2, column 2 in the middle.
  Eigen::Matrix<double, 2, 3> on(int t, int e) const;

  const std::vector<std::string>& unmet() const { return unmet_; }

  /// The traction of an Airy function at both ends of an edge, seen from where the way from a to b has the
  /// domain on its left.
  static Eigen::Matrix2d of_airy(const ContactPressure::Airy& a, const ContactPressure::Airy& b,
                                 const Vector& way);
  /// The same of one that is 0 on the edge with −∂_n ψ = s (1 − s), s ∈ [0, 1] along the way.
  static Eigen::Matrix2d of_turn(const Vector& way);

  /// Adds the tractions of an Airy function: (ψ, ∇ψ) of each point by columns, and what −∂_n ψ is of s (1 −
  /// s) on each edge, seen from where the way to the point of the larger number has the domain on its left.
  /// On Γ_C and Γ_F it must vanish.
  void add(const Eigen::Matrix3Xd& airy, const Eigen::VectorXd& turns);

 private:
  Eigen::Matrix2d& at(int edge) { return tractions_[edge]; }
  void take_from(const Eigen::MatrixXd& stress, Progress& progress);
  void change_pressure(const ContactPressure& pressure);
  void take_couples(Eigen::Matrix3Xd& moments);
  void balance(const Eigen::Matrix3Xd& moments, Progress& progress);
  void turn_around(int point, std::span<const int> triangles, const Eigen::Matrix3Xd& moments);

  const Discretization& discrete_;
  const TractionField& given_;
  /// Of each edge, seen from its first triangle, at the ends in the direction in which that triangle lies on
  /// the left.
  std::vector<Eigen::Matrix2d> tractions_;
  std::vector<std::string> unmet_;
};

}  // namespace signorini
