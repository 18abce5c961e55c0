#pragma once

#include <array>
#include <string>
#include <unordered_map>
#include <vector>

#include "certify/local_fields.hpp"
#include "certify/pressure/contact_chain.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The pressure p* on Γ_C: −σ_hn made nowhere negative, and 0 where the contact is open. The schemes have
/// that only in the mean over each clearance function; an iteration that its tolerance ended, only nearly.
///
/// p* − p_h is the derivative along Γ_C of a stream function Ψ that vanishes where Γ_C ends (but not where
/// Γ_D begins, whose traction is free), so that a stress without divergence makes the change: for a membrane
/// the curl of Ψ; for an elastic body Ψ is a vector, along the direction of each edge, and the Airy stress of
/// a function ψ makes the change, so that moments balance too.
///
/// Where a body touches with a single edge, the linear pressure that has the force and the moment of p_h may
/// be negative at one end. Then p* is steep: linear on a part of the edge next to the other end, with the
/// same force and moment. How the two differ counts as oscillation(). A contact that is too short may have no
/// such p* ≥ 0 either. What lacks then acts besides p* on the last edge of the chain, as a traction that Γ_D
/// has to take: Lack.
struct ContactPressure {
  /// ψ and ∇ψ at a point.
  struct Airy {
    double value = 0;
    Vector gradient = Vector::Zero();
  };

  /// A traction on an edge of Γ_C besides p*: its force, its moment about the middle of the edge, and of an
  /// elastic body its values at both ends, as EdgeTractions has them.
  struct Lack {
    int edge;
    double force, moment;
    Eigen::Matrix2d traction = Eigen::Matrix2d::Zero();
  };

  /// `clearance`: a value a row of the clearance space.
  ContactPressure(const Discretization& discrete, const Eigen::MatrixXd& stress,
                  const Eigen::VectorXd& clearance);

  /// p_τ of a dual problem: |p_τ| ≤ K p*, where p* is the pressure of the base. The factor K is the given
  /// one, or as large as what each chain takes as a whole needs; infinite if that has no pressure.
  ContactPressure(const Discretization& discrete, const Eigen::MatrixXd& stress, const ContactPressure& base,
                  double factor);

  /// The least K with |p_τ| ≤ K p*, p* of the base.
  double factor_beside(const ContactPressure& base) const;

  /// Ψ on a triangle.
  Quadratic<1> stream_function_on(const Mesh& mesh, int t) const;

  /// p* on edge i of the clearance space.
  EdgePressure on(const Discretization& discrete, int i) const;

  /// ‖p* − p‖ in L2 of an edge of the mesh for the linear p with the same force and moment.
  double beyond_linear(int edge) const;

  /// p*, or that linear p where p* is steep, at the first and the second point of each edge of the clearance
  /// space.
  std::vector<std::array<double, 2>> at_ends;
  /// How much that is more than p_h at the same points.
  std::vector<std::array<double, 2>> changes;
  /// p* where it is steep, by the edge of the mesh, with what it has beyond linear functions.
  struct Steep {
    EdgePressure pressure;
    double beyond_linear;
  };
  std::unordered_map<int, Steep> steep;
  /// Ψ, with the domain on the left, at points and at the middles of edges; 0 where it is not named.
  std::unordered_map<int, double> stream_function_at_points, stream_function_at_middles;
  /// ψ at points, for an elastic body.
  std::unordered_map<int, Airy> airy_at_points;
  std::vector<Lack> lacks;
  bool is_of_dual = false;  ///< it may have any sign, and stays what it is

 private:
  void spread(const Discretization& discrete, const ContactChain& given, const AdmissibleChain& chain,
              double rounding);
  AdmissibleChain admissible(const Discretization& discrete, const ContactChain& given,
                             const Eigen::VectorXd& clearance, double rounding);
  static AdmissibleChain within_bounds(const Discretization& discrete, const ContactChain& given,
                                       const ContactChain& bounds, double factor, double rounding);
  ContactChain with_own_forces(const Discretization& discrete, ContactChain chain) const;
  void keep(const Discretization& discrete, const ContactChain& given, const ContactChain& admissible);
  void keep_steep(const ContactPressure& base, const Discretization& discrete);
  void forget_rounding(const ContactPressure& base);
  void add_curl(const Discretization& discrete, const ContactChain& chain,
                const std::vector<double>& at_nodes, const std::vector<double>& means);
  void take_lack(const Discretization& discrete, const ContactChain& links, double sign,
                 std::vector<Vector>& w, std::vector<double>& psi);
  void add_airy(const Discretization& discrete, const ContactChain& given, const AdmissibleChain& chain,
                double scale);
};

}  // namespace signorini
