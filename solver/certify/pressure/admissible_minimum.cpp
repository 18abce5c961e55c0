#include "certify/pressure/admissible_minimum.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/SparseCholesky>

#include "fem/small_matrices.hpp"

namespace signorini {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kSteps = 20;
/// Pressures that would stop a step within this part of it are kept together.
constexpr double kTogether = 1e-3;
/// A constant stream function is no stress: where nothing else fixes it, this part of the diagonal does.
constexpr double kRegular = 1e-10;
/// Below this part of a row's coefficients what elimination leaves is rounding.
constexpr double kTermRounding = 1e-12;

double value(const LinearForm& form, const Eigen::VectorXd& x) {
  double sum = 0;
  for (const auto& [unknown, factor] : form) sum += factor * x[unknown];
  return sum;
}

/// Unknowns as combinations of those that are left free.
class FreeUnknowns {
 public:
  void take_away(const LinearForm& row) {
    Combination rest;
    double largest = 0;
    for (const auto& [unknown, factor] : row) {
      largest = std::max(largest, std::abs(factor));
      const auto known = known_.find(unknown);
      if (known == known_.end()) {
        rest[unknown] += factor;
        continue;
      }
      add(factor, known->second, rest);
      for (const auto& [other, share] : known->second) largest = std::max(largest, std::abs(factor * share));
    }
    // What is left of terms that cancel would fill the combinations.
    std::erase_if(rest, [&](const auto& term) { return std::abs(term.second) <= kTermRounding * largest; });
    const auto pivot =
        std::ranges::max_element(rest, {}, [](const auto& term) { return std::abs(term.second); });
    if (pivot == rest.end()) return;
    const auto [unknown, factor] = *pivot;
    rest.erase(pivot);
    for (auto& term : rest) term.second /= -factor;
    for (auto& [other, combination] : known_)
      if (const auto used = combination.find(unknown); used != combination.end()) {
        const double times = used->second;
        combination.erase(used);
        add(times, rest, combination);
      }
    known_.emplace(unknown, std::move(rest));
  }

  /// By columns, what a free unknown changes.
  Sparse basis(int unknowns) const {
    std::vector<int> column(unknowns);
    int columns = 0;
    for (int i = 0; i < unknowns; ++i) column[i] = known_.contains(i) ? -1 : columns++;
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < unknowns; ++i)
      if (column[i] >= 0) entries.emplace_back(i, column[i], 1);
    for (const auto& [unknown, combination] : known_)
      for (const auto& [other, factor] : combination) entries.emplace_back(unknown, column[other], factor);
    Sparse basis(unknowns, columns);
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
  }

 private:
  using Combination = std::map<int, double>;

  static void add(double times, const Combination& some, Combination& sum) {
    for (const auto& [unknown, factor] : some) {
      const double before = sum[unknown], after = sum[unknown] += times * factor;
      if (std::abs(after) <= kTermRounding * std::abs(before)) sum.erase(unknown);
    }
  }

  std::map<int, Combination> known_;
};

/// ½ y·H y + slope·y over the free unknowns y, with pressures added that must not change.
class Objective {
 public:
  Objective(const Sparse& curvature, const Eigen::VectorXd& slope, const std::vector<LinearForm>& kept)
      : basis_(null_space(static_cast<int>(slope.size()), kept)) {
    Sparse matrix = basis_.transpose() * curvature * basis_;
    matrix.diagonal() *= 1 + kRegular;
    factor_.compute(matrix);
    is_regular_ = basis_.cols() > 0 && factor_.info() == Eigen::Success;
    if (is_regular_) lowest_ = -factor_.solve(basis_.transpose() * slope);
    is_regular_ = is_regular_ && lowest_.allFinite();
  }

  bool is_regular() const { return is_regular_; }

  void keep(const LinearForm& form) {
    Eigen::VectorXd of_unknowns = Eigen::VectorXd::Zero(basis_.rows());
    for (const auto& [unknown, factor] : form) of_unknowns[unknown] += factor;
    const Eigen::VectorXd row = basis_.transpose() * of_unknowns;
    rows_.conservativeResize(rows_.rows() + 1, row.size());
    rows_.bottomRows<1>() = row.transpose();
    answers_.conservativeResize(row.size(), rows_.rows());
    answers_.rightCols<1>() = factor_.solve(row);
  }

  /// The minimum where the pressures kept are what they are at y.
  Eigen::VectorXd lowest_from(const Eigen::VectorXd& y) const {
    if (rows_.rows() == 0) return lowest_;
    const Eigen::MatrixXd between = rows_ * answers_;
    return lowest_ - answers_ * shortest_least_squares(between, rows_ * (lowest_ - y));
  }

  Eigen::VectorXd unknowns(const Eigen::VectorXd& y) const { return basis_ * y; }
  Eigen::VectorXd start() const { return Eigen::VectorXd::Zero(basis_.cols()); }

 private:
  const Sparse basis_;
  Eigen::SimplicialLDLT<Sparse> factor_;
  Eigen::VectorXd lowest_;
  bool is_regular_;
  Eigen::MatrixXd rows_, answers_;  ///< of the pressures kept: row·y, and H⁻¹ row
};

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

Sparse null_space(int unknowns, const std::vector<LinearForm>& rows) {
  FreeUnknowns free;
  for (const LinearForm& row : rows) free.take_away(row);
  return free.basis(unknowns);
}

Eigen::VectorXd admissible_minimum(const Sparse& curvature, Eigen::VectorXd slope,
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
  Objective objective(scale.asDiagonal() * curvature * scale.asDiagonal(), scale.cwiseProduct(slope),
                      conditions);
  if (!objective.is_regular()) return Eigen::VectorXd::Zero(slope.size());
  Eigen::VectorXd y = objective.start();
  for (int step = 0; step < kSteps; ++step) {
    progress.check();
    const Eigen::VectorXd change = objective.lowest_from(y) - y, x = objective.unknowns(change);
    double way = 1;
    for (const MovingPressure& own : moving)
      if (const double towards = value(own.change, x); !own.is_kept && own.value + way * towards < 0)
        way = own.value / -towards;
    y += way * change;
    for (MovingPressure& own : moving) {
      if (own.is_kept) continue;
      const double towards = value(own.change, x);
      own.is_kept = way < 1 && own.value + (way + kTogether) * towards <= 0;
      if (own.is_kept) objective.keep(own.change);
      own.value = std::max(0., own.value + way * towards);
    }
    if (way == 1) break;
  }
  return scale.cwiseProduct(objective.unknowns(y));
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
