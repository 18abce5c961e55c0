#include "certify/pressure/contact_pressure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "certify/pressure/contact_chain.hpp"
#include "mesh/parts.hpp"

namespace signorini {
namespace {

/// Below this part of the forces a difference is rounding.
constexpr double kForceRounding = 1e-12;

/// A chain adds up the rounding of all its edges.
constexpr double kNoLack = 100;

/// Ψ at the nodes of a chain, in the direction in which it runs, and its mean over each link.
struct ChainStreamFunction {
  ChainStreamFunction(const ContactChain& given, const AdmissibleChain& chain)
      : at_nodes(given.size() + 1, 0.) {
    const ContactChain& admissible = chain.links();
    for (std::size_t i = 0; i < given.size(); ++i)
      at_nodes[i + 1] = at_nodes[i] + admissible[i].force() - given[i].force();
    if (chain.is_held(false)) {
      // It vanishes where the chain ends freely, and where nothing was moved.
      const double begin = chain.is_held(true) ? -chain.force_of_support() : -at_nodes.back();
      for (double& value : at_nodes) value += begin;
    }
    for (std::size_t i = 0; i < given.size(); ++i)
      means.push_back(at_nodes[i] + admissible[i].forces[0] - given[i].forces[0]);
  }

  /// Lets Ψ vanish where the chain ends freely: what it would have there is left to a constant traction on
  /// the last link.
  double take_lack(const AdmissibleChain& chain) {
    if (!chain.has_free_ends()) return 0;
    means.back() -= at_nodes.back() / 2;
    return std::exchange(at_nodes.back(), 0.);
  }

  double largest() const {
    double most = 0;
    for (std::size_t i = 0; i < means.size(); ++i)
      most = std::max({most, std::abs(at_nodes[i]), std::abs(means[i]), std::abs(at_nodes[i + 1])});
    return most;
  }

  std::vector<double> at_nodes, means;
};

/// The pressure that is linear and 0 at one end of a part of the edge, and 0 beside that, with the force and
/// the moment of the linear one with these values at the ends, of which one is below 0. The two differ by
/// what is orthogonal to linear functions.
ContactPressure::Steep steep_on(int edge, const std::array<double, 2>& at_ends, double length) {
  const auto& [p, q] = at_ends;
  const double mean = (p + q) / 2, middle = (p + 2 * q) / (3 * (p + q));  // where the resultant acts
  const bool at_the_end = middle > 0.5;
  const double part = 3 * (at_the_end ? 1 - middle : middle), most = 2 * mean / part;
  const double square = length * (most * most * part - (p * p + p * q + q * q)) / 3;
  EdgePressure pressure{edge, {0, most}, 1 - part, 1};
  if (!at_the_end) pressure = {edge, {most, 0}, 0, part};
  return {pressure, std::sqrt(std::max(0., square))};
}

double value_or_zero(const std::unordered_map<int, double>& values, int key) {
  const auto found = values.find(key);
  return found == values.end() ? 0 : found->second;
}

}  // namespace

ContactPressure::ContactPressure(const Discretization& discrete, const Eigen::MatrixXd& stress,
                                 const Eigen::VectorXd& clearance)
    : at_ends(discrete.clearance.edges.size()), changes(at_ends.size()) {
  // Fluxes are forces: what an open chain has is rounding beside them.
  const double largest_flux = stress.cwiseAbs().maxCoeff();
  for (const ContactChain& given : contact_chains(discrete, stress)) {
    const double scale = kForceRounding * (sum_of_forces(given) + largest_flux);
    const AdmissibleChain chain = admissible(discrete, given, clearance, scale);
    keep(discrete, given, chain.links());
    spread(discrete, given, chain, scale);
  }
}

ContactPressure::ContactPressure(const Discretization& discrete, const Eigen::MatrixXd& stress,
                                 const ContactPressure& base, double factor)
    : at_ends(discrete.clearance.edges.size()), changes(at_ends.size()), is_of_dual(true) {
  const double largest_flux = stress.cwiseAbs().maxCoeff();
  for (const ContactChain& given : contact_chains(discrete, stress)) {
    const double scale = kForceRounding * (sum_of_forces(given) + largest_flux);
    const ContactChain bounds = base.with_own_forces(discrete, given);
    AdmissibleChain chain = within_bounds(discrete, given, bounds, factor, scale);
    // What the balance lacks is what it has, if nothing does better.
    if (discrete.spaces().components == 2 && chain.has_free_ends()) chain.balance(given, bounds, scale);
    keep(discrete, given, chain.links());
    spread(discrete, given, chain, scale);
  }
  keep_steep(base, discrete);
  forget_rounding(base);
}

/// What is nothing beside the largest does not tell what K is.
void ContactPressure::forget_rounding(const ContactPressure& base) {
  double largest = 0;
  for (const std::array<double, 2>& own : at_ends)
    largest = std::max({largest, std::abs(own[0]), std::abs(own[1])});
  std::vector<std::array<double, 2>> rounding = at_ends;
  for (std::size_t i = 0; i < at_ends.size(); ++i)
    for (const int k : {0, 1}) {
      const bool is_rounding = std::abs(at_ends[i][k]) <= kNoLack * kForceRounding * largest;
      (is_rounding ? at_ends : rounding)[i][k] = 0;
    }
  const double factor = factor_beside(base);
  for (std::size_t i = 0; i < at_ends.size(); ++i)
    for (const int k : {0, 1}) {
      const double most = factor * std::abs(base.at_ends[i][k]);
      at_ends[i][k] += std::clamp(rounding[i][k], -most, most);
    }
}

/// With the factor, or twice, four times it and so on, until the chain as a whole takes its force.
AdmissibleChain ContactPressure::within_bounds(const Discretization& discrete, const ContactChain& given,
                                               const ContactChain& bounds, double factor, double rounding) {
  constexpr int most_doublings = 30;
  for (int doublings = 0;; ++doublings, factor *= 2) {
    AdmissibleChain chain(discrete, given, bounds, factor, rounding);
    if (chain.is_within(bounds, factor, rounding) || doublings == most_doublings) return chain;
  }
}

double ContactPressure::factor_beside(const ContactPressure& base) const {
  double most = 0;
  for (std::size_t i = 0; i < at_ends.size(); ++i)
    for (const int k : {0, 1})
      if (at_ends[i][k] != 0) most = std::max(most, std::abs(at_ends[i][k] / base.at_ends[i][k]));
  return most;
}

/// The change of the pressure goes on into the body as a stress without divergence.
void ContactPressure::spread(const Discretization& discrete, const ContactChain& given,
                             const AdmissibleChain& chain, double scale) {
  if (discrete.spaces().components == 2) return add_airy(discrete, given, chain, scale);
  ChainStreamFunction stream_function(given, chain);
  if (const double lack = stream_function.take_lack(chain); std::abs(lack) > kNoLack * scale)
    lacks.push_back({discrete.clearance.edges[given.back().number].edge, std::abs(lack), 0});
  if (stream_function.largest() > scale)
    add_curl(discrete, chain.links(), stream_function.at_nodes, stream_function.means);
}

/// The links of the chain with the forces of this pressure.
ContactChain ContactPressure::with_own_forces(const Discretization& discrete, ContactChain chain) const {
  for (Link& link : chain) {
    auto [p, q] = at_ends[link.number];
    if (discrete.mesh.edges[discrete.clearance.edges[link.number].edge][0] != link.begin) std::swap(p, q);
    link.forces = {link.length * (2 * p + q) / 6, link.length * (p + 2 * q) / 6};
  }
  return chain;
}

/// Where the base is steep this is a multiple of it.
void ContactPressure::keep_steep(const ContactPressure& base, const Discretization& discrete) {
  for (std::size_t i = 0; i < at_ends.size(); ++i) {
    const auto found = base.steep.find(discrete.clearance.edges[i].edge);
    if (found == base.steep.end()) continue;
    const auto sum = [](const std::array<double, 2>& ends) { return ends[0] + ends[1]; };
    const double ratio = sum(at_ends[i]) / sum(base.at_ends[i]);
    Steep own = found->second;
    for (double& value : own.pressure.at_ends) value *= ratio;
    own.beyond_linear *= std::abs(ratio);
    steep.emplace(found->first, own);
  }
}

Quadratic<1> ContactPressure::stream_function_on(const Mesh& mesh, int t) const {
  Quadratic<1> values = Quadratic<1>::Zero();
  if (stream_function_at_points.empty()) return values;
  for (int k = 0; k < 3; ++k) {
    values[k] = value_or_zero(stream_function_at_points, mesh.triangles[t][k]);
    values[3 + k] = value_or_zero(stream_function_at_middles, mesh.triangle_edges[t][k]);
  }
  return values;
}

/// Of an elastic body force and moment must stay. An edge between closed and open is left without pressure
/// then, because its share would act with a moment, unless the contact is too short to balance it otherwise.
AdmissibleChain ContactPressure::admissible(const Discretization& discrete, const ContactChain& given,
                                            const Eigen::VectorXd& clearance, double rounding) {
  using Transition = AdmissibleChain::Transition;
  const AdmissibleChain loaded(discrete, given, clearance, Transition::loaded, AdmissibleChain::kLinear);
  if (discrete.spaces().components == 1) return loaded;
  for (const double least_share : {AdmissibleChain::kLinear, AdmissibleChain::kSteep})
    for (const Transition transition : {Transition::free, Transition::loaded}) {
      AdmissibleChain chain(discrete, given, clearance, transition, least_share);
      if (!chain.has_free_ends() || chain.balance(given, rounding)) return chain;
    }
  // What the balance lacks is what it has, if nothing does better.
  return loaded;
}

EdgePressure ContactPressure::on(const Discretization& discrete, int i) const {
  const int edge = discrete.clearance.edges[i].edge;
  const auto found = steep.find(edge);
  return found == steep.end() ? EdgePressure{edge, at_ends[i]} : found->second.pressure;
}

double ContactPressure::beyond_linear(int edge) const {
  const auto found = steep.find(edge);
  return found == steep.end() ? 0 : found->second.beyond_linear;
}

void ContactPressure::keep(const Discretization& discrete, const ContactChain& given,
                           const ContactChain& admissible) {
  for (std::size_t i = 0; i < given.size(); ++i) {
    const int edge = discrete.clearance.edges[given[i].number].edge;
    std::array<double, 2> pressure = admissible[i].pressure(), old = given[i].pressure();
    const bool is_turned = discrete.mesh.edges[edge][0] != given[i].begin;
    if (is_turned) {
      std::swap(pressure[0], pressure[1]);
      std::swap(old[0], old[1]);
    }
    for (int k = 0; k < 2; ++k) changes[given[i].number][k] = pressure[k] - old[k];
    if (!is_of_dual && admissible[i].is_steep())
      steep.emplace(edge, steep_on(edge, pressure, given[i].length));
    else if (!is_of_dual)
      for (double& value : pressure) value = std::max(0., value);
    at_ends[given[i].number] = pressure;
  }
}

void ContactPressure::add_curl(const Discretization& discrete, const ContactChain& chain,
                               const std::vector<double>& at_nodes, const std::vector<double>& means) {
  for (std::size_t i = 0; i < chain.size(); ++i) {
    const int edge = discrete.clearance.edges[chain[i].number].edge;
    const double sign = domain_on_the_left(discrete.mesh, edge)[0] == chain[i].begin ? 1 : -1;
    stream_function_at_points[chain[i].begin] = sign * at_nodes[i];
    stream_function_at_points[chain[i].end] = sign * at_nodes[i + 1];
    // The mean of a quadratic function over the edge is (a + 4 m + b) / 6.
    stream_function_at_middles[edge] = sign * (6 * means[i] - at_nodes[i] - at_nodes[i + 1]) / 4;
  }
}

/// Lets w and ψ vanish where the chain ends freely, by w − (s w(1) + 4 s (1 − s) β n) on its last link.
void ContactPressure::take_lack(const Discretization& discrete, const ContactChain& links, double sign,
                                std::vector<Vector>& w, std::vector<double>& psi) {
  const Mesh& mesh = discrete.mesh;
  const int edge = discrete.clearance.edges[links.back().number].edge;
  const double length = links.back().length;
  const Vector n = mesh.outward_normal(edge), force = w.back();
  const double rest = psi.back() - sign * length * n.dot(force) / 2, beta = 1.5 * rest / (sign * length);
  w.back().setZero();
  psi.back() = 0;
  // The derivative along the chain, at its begin and its end.
  const Vector at_begin = -sign / length * (force + 4 * beta * n),
               at_end = -sign / length * (force - 4 * beta * n);
  Lack lack{edge, force.norm(), 2. / 3 * std::abs(beta) * length};
  const bool on_the_left = domain_on_the_left(mesh, edge)[0] == links.back().begin;
  lack.traction << (on_the_left ? at_begin : at_end), (on_the_left ? at_end : at_begin);
  lacks.push_back(lack);
}

/// With w = (∂_y ψ, −∂_x ψ), whose derivative along Γ_C is the change −(p* − p_h) d of the traction, and
/// ψ' = w·n.
void ContactPressure::add_airy(const Discretization& discrete, const ContactChain& given,
                               const AdmissibleChain& chain, double scale) {
  const Mesh& mesh = discrete.mesh;
  const ContactChain& links = chain.links();
  const std::size_t count = links.size();
  // The domain lies on the left of the chain, or on its right.
  const int first_edge = discrete.clearance.edges[links[0].number].edge;
  const double sign = domain_on_the_left(mesh, first_edge)[0] == links[0].begin ? 1 : -1;

  std::vector<Vector> w{Vector::Zero()}, means;
  double largest = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector d = sign * discrete.clearance.edges[links[i].number].direction;
    const double change = links[i].force() - given[i].force(),
                 first_half = links[i].forces[0] - given[i].forces[0];
    largest = std::max({largest, std::abs(change), std::abs(first_half)});
    means.push_back(w.back() - first_half * d);
    w.push_back(w.back() - change * d);
  }
  if (largest <= scale) return;
  if (chain.is_held(false)) {
    // It vanishes where the chain ends freely, and where nothing was moved.
    const Vector d = sign * discrete.clearance.edges[links[0].number].direction,
                 begin = chain.is_held(true) ? Vector(chain.force_of_support() * d) : Vector(-w.back());
    for (Vector& own : w) own += begin;
    for (Vector& own : means) own += begin;
  }
  std::vector<double> psi{0};
  double length = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector n = mesh.outward_normal(discrete.clearance.edges[links[i].number].edge);
    psi.push_back(psi.back() + sign * links[i].length * n.dot(means[i]));
    length += links[i].length;
  }
  if (chain.is_held(false)) {
    const double rest = psi.back();
    for (double& value : psi) value -= rest;
  }
  if (chain.has_free_ends() && std::max(w.back().norm(), std::abs(psi.back()) / length) > kNoLack * scale)
    take_lack(discrete, links, sign, w, psi);
  const auto set = [&](int point, std::size_t i) {
    airy_at_points[point] = {psi[i], Vector(-w[i].y(), w[i].x())};
  };
  set(links[0].begin, 0);
  for (std::size_t i = 0; i < count; ++i) set(links[i].end, i + 1);
}

}  // namespace signorini
