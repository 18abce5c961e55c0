#include "result/in_range.hpp"

#include <algorithm>

namespace signorini {
namespace {

/// Differences of stresses and their norms are this many times as large, at most.
constexpr double kOfInvariants = 8;

/// One overload for each kind of what a solution holds.
struct InRange {
  bool operator()(double number) const { return std::isfinite(number); }
  bool operator()(const Point& point) const { return point.allFinite(); }

  template <typename Item>
  bool operator()(const std::optional<Item>& item) const {
    return !item || (*this)(*item);
  }
  template <typename Item>
  bool operator()(const std::vector<Item>& items) const {
    return std::ranges::all_of(items, [this](const Item& own) { return (*this)(own); });
  }
  template <typename... Items>
  bool all(const Items&... items) const {
    return (... && (*this)(items));
  }

  /// Its ends may be infinite.
  static bool is_interval(double lower, double upper) { return !std::isnan(lower) && !std::isnan(upper); }

  bool operator()(const EnclosedNumber& number) const {
    return all(number.value, number.estimate) && is_interval(number.lower, number.upper);
  }
  bool operator()(const EnclosedQuantity& quantity) const {
    return all(quantity.value, quantity.estimate) && is_interval(quantity.lower, quantity.upper) &&
           quantity.shares.allFinite();
  }
  bool operator()(const ErrorBound& bound) const {
    const auto& [constitutive, contact, oscillation, equilibration, asymmetry] = bound.parts;
    return all(bound.value, bound.relative, bound.energy_lower, bound.energy_upper, bound.work, constitutive,
               contact, oscillation, equilibration, asymmetry);
  }
  bool operator()(const CertifiedStretch& stretch) const {
    return all(stretch.carries_at_most, stretch.opens_at_most);
  }
  bool operator()(const CertifiedSupport& support) const {
    return all(support.force, support.moment, support.pressure_force, support.stretches);
  }
  bool operator()(const Certified& certified) const {
    return all(certified.energy, certified.work, certified.supports);
  }

  bool operator()(const Reaction& reaction) const { return all(reaction.force, reaction.moment); }
  bool operator()(const ContactSummary& sums) const {
    return all(sums.force, sums.max_pressure, sums.length);
  }
  bool operator()(const ContactPart& part) const {
    return all(part.points, part.clearance, part.pressure, part.gap, part.weight);
  }
  bool operator()(const EdgePressure& pressure) const {
    return all(pressure.at_ends[0], pressure.at_ends[1]);
  }
  bool operator()(const Residuals& residuals) const {
    const auto& [equilibrium, constitutive, penetration, tension, complementarity, symmetry] = residuals;
    return all(equilibrium, constitutive, penetration, tension, complementarity, symmetry);
  }

  bool operator()(const SweepEntry& entry) const {
    return all(entry.energy, entry.penetration, entry.tension, entry.complementarity, entry.sums, entry.parts,
               entry.contact, entry.error_bound, entry.quantities);
  }
  bool operator()(const Solution& solution) const {
    const Summary& summary = solution.summary;
    return all(summary.energy, summary.residuals, summary.contact, summary.parts, solution.contact) &&
           solution.stress.allFinite() && solution.displacement.allFinite() &&
           solution.rotation.allFinite() && solution.displacement_at_points.allFinite() &&
           (kOfInvariants * solution.stress_at_centroids).allFinite() &&
           (kOfInvariants * solution.out_of_plane_stress).allFinite();
  }
};

}  // namespace

bool is_in_range(const ErrorBound& bound) {
  return InRange()(bound);
}

bool is_in_range(const Certified& certified) {
  return InRange()(certified);
}

bool is_in_range(const SweepEntry& entry) {
  return InRange()(entry);
}

bool is_in_range(const Solution& solution) {
  return InRange()(solution);
}

}  // namespace signorini
