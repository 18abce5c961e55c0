#include "certify/pressure/admissible_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "fem/sparse_ldlt.hpp"

namespace signorini {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kSteps = 20;
/// Pressures that would stop a step within this part of it are kept together.
constexpr double kTogether = 1e-3;
/// A constant stream function is no stress: where nothing else fixes it, this part of the diagonal does.
constexpr double kRegular = 1e-10;

double value(const LinearForm& form, const Eigen::VectorXd& x) {
  double sum = 0;
  for (const auto& [unknown, factor] : form) sum += factor * x[unknown];
  return sum;
}

/// The way from x to the minimum of ½ x·curvature x + slope·x where the unknowns are what the free ones make
/// of them; nothing where it has none.
std::optional<Eigen::VectorXd> way_to_minimum(const Sparse& curvature, const Eigen::VectorXd& slope,
                                              const Eigen::VectorXd& x, const FreeUnknowns& free,
                                              Progress& progress) {
  const Sparse basis = free.basis(static_cast<int>(x.size()));
  if (basis.cols() == 0) return std::nullopt;
  Sparse matrix = Sparse(basis.transpose() * curvature * basis).triangularView<Eigen::Lower>();
  matrix.diagonal() *= 1 + kRegular;
  try {
    const SparseLdlt factor(matrix, progress);
    Eigen::VectorXd way = basis * -factor.solve(basis.transpose() * (slope + curvature * x), progress);
    if (!way.allFinite()) return std::nullopt;
    return way;
  } catch (const SingularPivot&) {
    return std::nullopt;
  }
}

}  // namespace

std::array<MovingPressure, 2> moving_pressures(const Discretization& discrete,
                                               const AdmissibleDisplacement& v,
                                               const Eigen::VectorXd& clearance,
                                               const ContactPressure& pressure, int i,
                                               std::array<LinearForm, 2> changes) {
  const ContactEdge& contact = discrete.clearance.edges[i];
  Eigen::Vector2d rooms = Eigen::Vector2d::Zero();
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q];
    rooms += edge_rule().weights[q] * discrete.mesh.length(contact.edge) * std::max(0., v.room(contact, s)) *
             Eigen::Vector2d(1 - s, s);
  }
  const bool open = clearance[contact.rows[0]] > 0 && clearance[contact.rows[1]] > 0;
  const bool is_kept = open || pressure.is_of_dual || pressure.steep.contains(contact.edge);
  const auto& [first, second] = pressure.at_ends[i];
  return {MovingPressure{i, 0, first, std::move(changes[0]), rooms[0], is_kept},
          MovingPressure{i, 1, second, std::move(changes[1]), rooms[1], is_kept}};
}

Eigen::VectorXd admissible_minimum(Sparse&& curvature, Eigen::VectorXd slope,
                                   std::vector<MovingPressure> moving, std::vector<LinearForm> conditions,
                                   Progress& progress) {
  // The unknowns may have units of their own.
  const Eigen::VectorXd scale = curvature.diagonal().cwiseSqrt().cwiseInverse();
  const auto to_scale = [&](LinearForm& form) {
    for (auto& [unknown, factor] : form) factor *= scale[unknown];
  };
  for (LinearForm& condition : conditions) to_scale(condition);
  for (MovingPressure& own : moving) {
    for (const auto& [unknown, factor] : own.change) slope[unknown] += own.room * factor;
    to_scale(own.change);
    if (own.is_kept) conditions.push_back(own.change);
  }
  for (int column = 0; column < curvature.outerSize(); ++column)
    for (Sparse::InnerIterator entry(curvature, column); entry; ++entry)
      entry.valueRef() *= scale[entry.row()] * scale[column];
  slope = scale.cwiseProduct(slope);
  FreeUnknowns free;
  for (const LinearForm& condition : conditions) free.take_away(condition);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(slope.size());
  for (int step = 0; step < kSteps; ++step) {
    progress.check();
    const std::optional<Eigen::VectorXd> change = way_to_minimum(curvature, slope, x, free, progress);
    if (!change) break;
    double way = 1;
    for (const MovingPressure& own : moving)
      if (const double towards = value(own.change, *change); !own.is_kept && own.value + way * towards < 0)
        way = own.value / -towards;
    x += way * *change;
    for (MovingPressure& own : moving) {
      if (own.is_kept) continue;
      const double towards = value(own.change, *change);
      own.is_kept = way < 1 && own.value + (way + kTogether) * towards <= 0;
      if (own.is_kept) free.take_away(own.change);
      own.value = std::max(0., own.value + way * towards);
    }
    if (way == 1) break;
  }
  return scale.cwiseProduct(x);
}

void move(const std::vector<MovingPressure>& moving, const Eigen::VectorXd& x, ContactPressure& pressure) {
  for (const MovingPressure& own : moving) {
    if (own.is_kept) continue;
    const double change = value(own.change, x);
    pressure.at_ends[own.edge][own.end] = std::max(0., own.value + change);
    pressure.changes[own.edge][own.end] += change;
  }
}

}  // namespace signorini
