#include "certify/pressure/contact_chain.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

class Chains {
 public:
  Chains(const Discretization& discrete, const Eigen::MatrixXd& stress) : discrete_(discrete) {
    int part = -1;
    for (int i = 0; i < static_cast<int>(discrete.clearance.edges.size()); ++i) {
      const auto& [a, b] = points(i);
      const bool follows = part_of(i) == part && (a == all.back().back().end || b == all.back().back().end);
      if (!follows) all.emplace_back();
      const bool forward = follows ? a == all.back().back().end : !goes_on_from(a, i);
      all.back().push_back(make_link(i, forward, stress));
      part = part_of(i);
    }
  }

  std::vector<ContactChain> all;

 private:
  int part_of(int i) const { return discrete_.clearance.rows[discrete_.clearance.edges[i].rows[0]].part; }
  const std::array<int, 2>& points(int i) const {
    return discrete_.mesh.edges[discrete_.clearance.edges[i].edge];
  }

  /// The next edge of the part begins in the point.
  bool goes_on_from(int point, int i) const {
    if (i + 1 == static_cast<int>(discrete_.clearance.edges.size()) || part_of(i + 1) != part_of(i))
      return false;
    return points(i + 1)[0] == point || points(i + 1)[1] == point;
  }

  /// The forces from the outward fluxes; −σ_n is σ·n for the membrane. A constant pressure acts in equal
  /// parts on both hats.
  Link make_link(int number, bool forward, const Eigen::MatrixXd& stress) const {
    const ContactEdge& contact = discrete_.clearance.edges[number];
    const auto& [a, b] = points(number);
    Link link{number,       forward ? a : b, forward ? b : a,
              contact.rows, {0, 0},          discrete_.mesh.length(contact.edge)};
    const int per_edge = discrete_.spaces().traces_per_edge(), d = discrete_.spaces().components;
    const int t = discrete_.mesh.edge_triangles[contact.edge][0];
    const int first = discrete_.mesh.local_edge(t, contact.edge) * per_edge;
    for (int j = first; j < first + per_edge; j += d)
      link.forces[discrete_.traces.dof(t, j) % per_edge / d] =
          d == 1 ? stress(j, t) : -contact.direction.dot(stress.col(t).segment<2>(j));
    if (per_edge == d) link.forces = {link.forces[0] / 2, link.forces[0] / 2};
    if (!forward) {
      std::swap(link.forces[0], link.forces[1]);
      std::swap(link.rows[0], link.rows[1]);
    }
    return link;
  }

  const Discretization& discrete_;
};

/// The translations along x and y and the rotation about the middle of a chain, in units of its size.
class ChainMotions {
 public:
  ChainMotions(const Discretization& discrete, const ContactChain& chain)
      : discrete_(discrete), middle_((at(chain.front().begin) + at(chain.back().end)) / 2) {
    for (const Link& link : chain) size_ += link.length;
  }

  /// What each of them is along the direction of contact where the link begins and where it ends.
  std::array<Eigen::Vector3d, 2> along(const Link& link) const {
    const Vector& d = discrete_.clearance.edges[link.number].direction;
    std::array<Eigen::Vector3d, 2> motions;
    for (int end = 0; end < 2; ++end) {
      const Vector r = (at(end == 0 ? link.begin : link.end) - middle_) / size_;
      motions[end] = {d.x(), d.y(), d.y() * r.x() - d.x() * r.y()};
    }
    return motions;
  }

  /// The work on them of the forces of a chain: its force and its moment.
  Eigen::Vector3d work(const ContactChain& chain) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Link& link : chain) {
      const auto [begin, end] = along(link);
      sum += link.forces[0] * begin + link.forces[1] * end;
    }
    return sum;
  }

 private:
  const Point& at(int point) const { return discrete_.mesh.points[point]; }

  const Discretization& discrete_;
  Point middle_;
  double size_ = 0;
};

/// The forces of the linear pressure with the given values at the ends.
std::array<double, 2> forces_of(double begin, double end, double length) {
  return {length * (2 * begin + end) / 6, length * (begin + 2 * end) / 6};
}

/// The pressure of a chain times the component r·d of a rigid motion r along the direction of contact.
class PressureTimesMotion {
 public:
  /// `by_mean`: of a link on which r·d counts with its mean.
  using ByMean = std::function<bool(const Link&)>;
  PressureTimesMotion(const ChainMotions& motions, const ContactChain& chain, ByMean by_mean)
      : by_mean_(std::move(by_mean)) {
    for (const Link& link : chain) {
      const auto [begin, end] = motions.along(link);
      for (int k = 0; k < 3; ++k) {
        const auto [first, second] = forces(link, begin[k], end[k]);
        matrix_.col(k) += first * begin + second * end;
      }
    }
  }

  /// The forces of the link's pressure times the values at its ends.
  std::array<double, 2> forces(const Link& link, double begin, double end) const {
    const auto [p, q] = link.pressure();
    if (by_mean_(link)) begin = end = (begin + end) / 2;
    return forces_of(p * begin, q * end, link.length);
  }

  /// The motion with which it has this force and moment, and by how much they are missed.
  Eigen::Vector3d motion_for(const Eigen::Vector3d& lack) const {
    // A motion along a straight chain does no work, and the rotation about the middle of an arc hardly any.
    return shortest_least_squares(matrix_, lack, 1e-13);
  }
  double misses(const Eigen::Vector3d& lack, const Eigen::Vector3d& motion) const {
    return (matrix_ * motion - lack).norm();
  }

 private:
  ByMean by_mean_;
  Eigen::Matrix3d matrix_ = Eigen::Matrix3d::Zero();
};

}  // namespace

std::vector<ContactChain> contact_chains(const Discretization& discrete, const Eigen::MatrixXd& stress) {
  return Chains(discrete, stress).all;
}

double sum_of_forces(const ContactChain& chain) {
  double sum = 0;
  for (const Link& link : chain) sum += std::abs(link.forces[0]) + std::abs(link.forces[1]);
  return sum;
}

AdmissibleChain::AdmissibleChain(const Discretization& discrete, ContactChain chain,
                                 const Eigen::VectorXd& clearance, Transition transition, double least_share)
    : discrete_(discrete), chain_(std::move(chain)), least_share_(least_share) {
  if (discrete.spaces().order == 1)
    for (std::size_t node = 0; node <= chain_.size(); ++node) move_at_node(node, clearance, transition);
  carry_deficits();
  for (Link& link : chain_) spread(link);
  if (std::ranges::all_of(chain_, [this](const Link& link) { return is_far(link); }))
    for (Link& link : chain_) link.forces = {0, 0};
}

bool AdmissibleChain::is_held(bool at_end) const {
  const int row = at_end ? chain_.back().rows[1] : chain_.front().rows[0];
  return discrete_.clearance.rows[row].unknown < 0;
}

/// Across a node, from the edge before it to the edge behind it.
void AdmissibleChain::move(std::size_t node, double force) {
  if (node > 0)
    chain_[node - 1].forces[1] -= force;
  else
    force_of_support_ += force;
  if (node < chain_.size()) chain_[node].forces[0] += force;
}

bool AdmissibleChain::is_open(std::size_t link, const Eigen::VectorXd& clearance) const {
  return clearance[chain_[link].rows[0]] > 0 || clearance[chain_[link].rows[1]] > 0;
}

/// Its foundation was drawn near: rounding that pushes there would count with the whole of the true gap.
bool AdmissibleChain::is_far(const Link& link) const {
  const auto& rows = discrete_.clearance.rows;
  return rows[link.rows[0]].beyond > 0 && rows[link.rows[1]].beyond > 0;
}

/// The force on the hat of a node is not negative, and 0 if the node is open; neither of its edges is left
/// with a negative share of it. Beyond the end of the chain Γ_D takes it.
void AdmissibleChain::move_at_node(std::size_t node, const Eigen::VectorXd& clearance,
                                   Transition transition) {
  const bool first = node == 0, last = node == chain_.size();
  if ((first || last) && !is_held(last)) return;
  const double before = first ? 0 : chain_[node - 1].forces[1], behind = last ? 0 : chain_[node].forces[0];
  const bool open_before = !first && is_open(node - 1, clearance),
             open_behind = !last && is_open(node, clearance);
  const bool empties = first || last || transition == Transition::free;
  if (empties && open_behind != open_before)
    move(node, open_behind ? -behind : before);
  else if (behind < 0)
    move(node, -behind);
  else if (before < 0)
    move(node, before);
}

/// What is still negative, from the tolerance of an iteration, is carried along the chain.
void AdmissibleChain::carry_deficits() {
  for (std::size_t i = 0; i + 1 < chain_.size(); ++i)
    if (chain_[i].force() < 0 || is_far(chain_[i])) carry(i, i + 1);
  for (std::size_t i = chain_.size(); i-- > 1;)
    if (chain_[i].force() < 0 || is_far(chain_[i])) carry(i, i - 1);
}

/// Leaves the one edge with no force.
void AdmissibleChain::carry(std::size_t from, std::size_t to) {
  const double lack = chain_[from].force();
  if (to > from)
    move(to, lack);
  else
    move(from, -lack);
}

/// No end is left with less than its least share of the force.
void AdmissibleChain::spread(Link& link) const {
  const double force = std::max(0., link.force());
  const double at_begin = discrete_.spaces().order == 0
                              ? force / 2
                              : std::clamp(link.forces[0], least_share_ * force, (1 - least_share_) * force);
  link.forces = {at_begin, force - at_begin};
}

AdmissibleChain::AdmissibleChain(const Discretization& discrete, ContactChain chain, const ContactChain& base,
                                 double factor, double rounding)
    : discrete_(discrete), chain_(std::move(chain)), least_share_(0) {
  const auto excess = [&](std::size_t i) {
    const double most = factor * base[i].force();
    return chain_[i].force() - std::clamp(chain_[i].force(), -most, most);
  };
  // Γ_D takes what comes to its end.
  const std::size_t last = chain_.size() - 1;
  for (std::size_t i = 0; i < last || (i == last && is_held(true)); ++i) move(i + 1, excess(i));
  for (std::size_t i = last; i > 0 || is_held(false); --i) {
    move(i, -excess(i));
    if (i == 0) break;
  }
  for (std::size_t i = 0; i <= last; ++i) {
    if (excess(i) != 0 && std::abs(chain_[i].force()) <= rounding) chain_[i].forces = {0, 0};
    keep_within(base[i], factor, chain_[i]);
  }
}

bool AdmissibleChain::is_within(const ContactChain& base, double factor, double rounding) const {
  for (std::size_t i = 0; i < chain_.size(); ++i)
    if (std::abs(chain_[i].force()) > factor * base[i].force() + rounding) return false;
  return true;
}

/// The ends of a link share its force, which is at most the factor times that of the base, as the bounds at
/// both let them.
void AdmissibleChain::keep_within(const Link& base, double factor, Link& link) const {
  const double mean = link.force() / link.length;
  const auto [p, q] = base.pressure();
  if (discrete_.spaces().order == 0 || base.is_steep()) {
    const double ratio = base.force() > 0 ? link.force() / base.force() : 0;
    link.forces = {ratio * base.forces[0], link.force() - ratio * base.forces[0]};
    return;
  }
  const double most = factor * p, other = factor * q, low = std::max(-most, 2 * mean - other),
               high = std::min(most, 2 * mean + other);
  double begin = std::clamp(link.pressure()[0], std::min(low, high), high);
  if (p <= 0) begin = 0;
  if (q <= 0) begin = 2 * mean;
  link.forces = forces_of(begin, 2 * mean - begin, link.length);
}

bool AdmissibleChain::balance(const ContactChain& given, double rounding) {
  if (sum_of_forces(given) <= rounding) {
    for (Link& link : chain_) link.forces = {0, 0};
    return true;
  }
  const ChainMotions motions(discrete_, chain_);
  const PressureTimesMotion changes(motions, chain_,
                                    [&](const Link&) { return discrete_.spaces().order == 0; });
  const Eigen::Vector3d lack = motions.work(given) - motions.work(chain_), mu = changes.motion_for(lack);
  bool pushes = changes.misses(lack, mu) <= 10 * rounding;
  for (Link& link : chain_) {
    const auto [at_begin, at_end] = motions.along(link);
    const double begin = 1 + mu.dot(at_begin), end = 1 + mu.dot(at_end);
    pushes = pushes && (link.force() == 0 || (begin >= 0 && end >= 0));
    link.forces = changes.forces(link, begin, end);
    pushes = pushes && (discrete_.spaces().order == 0 ||
                        std::min(link.forces[0], link.forces[1]) >= (1 - 1e-9) * least_share_ * link.force());
  }
  return pushes;
}

bool AdmissibleChain::balance(const ContactChain& given, const ContactChain& base, double rounding) {
  const ChainMotions motions(discrete_, chain_);
  const PressureTimesMotion changes(
      motions, base, [&](const Link& link) { return discrete_.spaces().order == 0 || link.is_steep(); });
  const Eigen::Vector3d lack = motions.work(given) - motions.work(chain_);
  if (lack.norm() <= rounding) return true;
  const Eigen::Vector3d mu = changes.motion_for(lack);
  if (!(changes.misses(lack, mu) <= 10 * rounding)) return false;
  for (std::size_t i = 0; i < chain_.size(); ++i) {
    const auto [at_begin, at_end] = motions.along(base[i]);
    const auto [begin, end] = changes.forces(base[i], mu.dot(at_begin), mu.dot(at_end));
    chain_[i].forces[0] += begin;
    chain_[i].forces[1] += end;
  }
  return true;
}

}  // namespace signorini
