#include "certify/quantities/reflection.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "certify/displacement/gap_bubble.hpp"

namespace signorini {
namespace {

/// Of all edges together.
constexpr int kCells = 20'000;

/// Of the largest displacement and pressure, as AdmissibleDisplacement and ContactPressure have it.
constexpr double kRoundingOfPairs = 1e-12;

class Reflection {
 public:
  Reflection(const CertifiedSolution& base, const CertifiedSolution& plus, const Quantity& quantity, double z)
      : base_(base), plus_(plus), quantity_(quantity), z_(z) {
    double pressure = 0, displacement = 0;
    const auto& edges = base.discrete.clearance.edges;
    for (std::size_t i = 0; i < edges.size(); ++i)
      for (const int k : {0, 1}) {
        pressure = std::max(pressure, base.pair.pressure.at_ends[i][k]);
        displacement = std::max(displacement, std::abs(base.pair.v.along_contact(edges[i], k)));
      }
    least_pressure_ = -kRoundingOfPairs * pressure;
    least_room_ = -kRoundingOfPairs * displacement;
  }

  bool has_pressure(int i) const {
    const ContactPressure &own = base_.pair.pressure, &other = plus_.pair.pressure;
    const int edge = base_.discrete.clearance.edges[i].edge;
    if (own.steep.contains(edge) || other.steep.contains(edge)) return false;
    return std::ranges::all_of(std::array{0, 1}, [&](int k) {
      return reflected(own.at_ends[i][k], other.at_ends[i][k]) >= least_pressure_;
    });
  }

  /// Where both follow their gaps the reflection does, too, but for what they are off.
  bool is_below_gap(int i, CellBudget& budget) const {
    const ContactEdge& contact = base_.discrete.clearance.edges[i];
    const AdmissibleDisplacement &v = base_.pair.v, &other = plus_.pair.v;
    const auto off = v.off_followed_gap(contact), other_off = other.off_followed_gap(contact);
    if (off && other_off) return reflected(*off, *other_off) >= least_room_;
    if (off || other_off) return false;
    const auto along = [&](double s) {
      return reflected(v.along_contact(contact, s), other.along_contact(contact, s));
    };
    const auto room = [&](double s) { return reflected(v.room(contact, s), other.room(contact, s)); };
    if (room(0) < least_room_ || room(1) < least_room_) return false;
    const Field gap = reflected_gap(contact);
    const EdgeLine line(base_.discrete.mesh, contact.edge);
    return BelowGap{gap, line, {along(0), along(0.5), along(1)}, {room(0), room(1)}}.bubble(budget) <=
           -least_room_;
  }

 private:
  double reflected(double own, double other) const { return 2 * own - other; }

  Field reflected_gap(const ContactEdge& contact) const {
    const ClearanceSpace& space = base_.discrete.clearance;
    const std::string& part = base_.discrete.mesh.boundary[space.rows[contact.rows[0]].part].name;
    const Field& gap = gap_on(base_.discrete, contact);
    const auto weight = quantity_.weights.find(part);
    return weight == quantity_.weights.end() ? gap : gap.plus(-z_, weight->second);
  }

  const CertifiedSolution &base_, &plus_;
  const Quantity& quantity_;
  const double z_;
  double least_pressure_, least_room_;
};

}  // namespace

bool is_admissible_reflected(const CertifiedSolution& base, const CertifiedSolution& plus,
                             const Quantity& quantity, double z, Progress& progress) {
  const Reflection reflection(base, plus, quantity, z);
  CellBudget budget{kCells, &progress};
  const int edges = static_cast<int>(base.discrete.clearance.edges.size());
  for (int i = 0; i < edges; ++i) {
    bool below = false;
    if (reflection.has_pressure(i))
      budget.share(edges - i, [&](CellBudget& own) { below = reflection.is_below_gap(i, own); });
    if (!below) return false;
  }
  return true;
}

}  // namespace signorini
