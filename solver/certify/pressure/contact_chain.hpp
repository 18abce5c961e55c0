#pragma once

#include <algorithm>

#include "fem/discretization.hpp"

namespace signorini {

/// One edge of a chain as it is run through, from point `begin` to point `end`.
struct Link {
  int number;  ///< in the clearance space
  int begin, end;
  std::array<int, 2> rows;       ///< of the clearance, at begin and end
  std::array<double, 2> forces;  ///< ∫ p φ for the hat functions φ of begin and end
  double length;

  double force() const { return forces[0] + forces[1]; }
  /// The linear pressure with these forces, at begin and end.
  std::array<double, 2> pressure() const {
    return {(4 * forces[0] - 2 * forces[1]) / length, (4 * forces[1] - 2 * forces[0]) / length};
  }
  /// That one is negative at an end, by more than rounding.
  bool is_steep() const { return std::min(forces[0], forces[1]) < (1 - 1e-9) / 3 * force(); }
};

/// Consecutive contact edges of one part.
using ContactChain = std::vector<Link>;

/// All chains, with the forces of −σ_hn.
std::vector<ContactChain> contact_chains(const Discretization& discrete, const Eigen::MatrixXd& stress);

/// Of their sizes: what a force of the chain is small beside.
double sum_of_forces(const ContactChain& chain);

/// A chain whose pressure is made admissible: forces are moved from edge to edge and from end to end, none
/// further than it must.
class AdmissibleChain {
 public:
  /// What an edge does that is open at one end and closed at the other: it takes its share of the force at
  /// the closed end, or none.
  enum class Transition { loaded, free };

  /// What each end of an edge must have of its force: for a linear pressure ≥ 0, and for one that is steep.
  static constexpr double kLinear = 1. / 3, kSteep = 1. / 20;

  AdmissibleChain(const Discretization& discrete, ContactChain chain, const Eigen::VectorXd& clearance,
                  Transition transition, double least_share);

  /// Of a dual problem: the pressure at each end of an edge is at most a factor times that of the base, and a
  /// multiple of it on all of an edge where the base is steep.
  AdmissibleChain(const Discretization& discrete, ContactChain chain, const ContactChain& base, double factor,
                  double rounding);

  /// No link has more than the factor times the force of the base.
  bool is_within(const ContactChain& base, double factor, double rounding) const;

  const ContactChain& links() const { return chain_; }

  /// Of an elastic body: multiplies the pressure by 1 + r·d, where d is the direction of contact and r a
  /// rigid motion, such that force and moment are those of the given chain again. Returns false if the
  /// pressure would turn negative.
  bool balance(const ContactChain& given, double rounding);
  /// Of a dual problem: adds the pressure of the base times r·d. Returns false if that does not do.
  bool balance(const ContactChain& given, const ContactChain& base, double rounding);

  /// Neither end of the chain lies on Γ_D.
  bool has_free_ends() const { return !is_held(false) && !is_held(true); }

  /// An end of the chain lies on Γ_D.
  bool is_held(bool at_end) const;

  /// What Γ_D gave to the chain where it begins.
  double force_of_support() const { return force_of_support_; }

 private:
  void move(std::size_t node, double force);
  void move_at_node(std::size_t node, const Eigen::VectorXd& clearance, Transition transition);
  void carry_deficits();
  void carry(std::size_t from, std::size_t to);
  void spread(Link& link) const;
  void keep_within(const Link& base, double factor, Link& link) const;
  bool is_open(std::size_t link, const Eigen::VectorXd& clearance) const;
  bool is_far(const Link& link) const;

  const Discretization& discrete_;
  ContactChain chain_;
  double least_share_;
  double force_of_support_ = 0;
};

}  // namespace signorini
