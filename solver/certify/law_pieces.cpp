#include "certify/law_pieces.hpp"

#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "fem/raviart_thomas.hpp"

namespace signorini {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The least tolerance where the law jumps along a curve, on a few triangles.
constexpr double kToleranceOfJumps = 2e-4;

constexpr int kOrders = LawPiece::kOrders;
using Errors = std::array<double, kOrders>;

struct Quality {
  Errors errors;
  double softest, stiffest;
};

Quality unknown() {
  Errors errors;
  errors.fill(kInfinity);
  return {errors, kInfinity, kInfinity};
}

/// What a value differs from a polynomial of degree k − 1 by.
double error(const TaylorModel& value, int k) {
  return k > TaylorModel::kDegree ? value.remainder() : kInfinity;
}
double error(const Series& value, int k) {
  return largest(value[k]);
}

template <typename Value>
concept Enclosing = std::same_as<Value, Series> || std::same_as<Value, TaylorModel>;

template <Enclosing Value>
Value operator+(const Value& a, const Value& b) {
  return smooth(Operation::add, a, b);
}
template <Enclosing Value>
Value operator-(const Value& a, const Value& b) {
  return smooth(Operation::subtract, a, b);
}
template <Enclosing Value>
Value operator*(const Value& a, const Value& b) {
  return smooth(Operation::multiply, a, b);
}
template <Enclosing Value>
Value operator/(const Value& a, const Value& b) {
  return smooth(Operation::divide, a, b);
}

/// A symmetric matrix of enclosures.
template <int N, typename Value>
struct EnclosedMatrix {
  std::array<std::array<Value, N>, N> entries;

  using Numbers = Eigen::Matrix<double, N, N>;

  /// What `of` takes from the entries.
  template <typename Of>
  Numbers map(const Of& of) const {
    Numbers numbers;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j) numbers(i, j) = of(entries[i][j]);
    return numbers;
  }

  Value cofactor(int row, int column) const {
    if constexpr (N == 2) {
      const Value& own = entries[1 - row][1 - column];
      return row == column ? own : smooth(Operation::negate, own);
    } else {
      const int a = (row + 1) % 3, b = (row + 2) % 3, c = (column + 1) % 3, d = (column + 2) % 3;
      return entries[a][c] * entries[b][d] - entries[a][d] * entries[b][c];
    }
  }
};

/// A bound of the norm of symmetric matrices T A Tᵀ whose entries are at most this large.
template <typename Matrix>
double largest_of(const Matrix& transform, const Matrix& entries) {
  if (!entries.allFinite()) return kInfinity;
  const Matrix t = transform.cwiseAbs();
  return (t * entries * t.transpose()).rowwise().sum().maxCoeff();
}

/// All is compared with the middle M = L Lᵀ of the enclosed values, of which they differ by at most s times M: entries
/// of very different sizes do no harm.
template <int N, typename Value>
Quality quality(const EnclosedMatrix<N, Value>& stiffness) {
  using Numbers = typename EnclosedMatrix<N, Value>::Numbers;
  const Numbers radii = stiffness.map([](const Value& own) {
    return is_known(range(own)) ? (range(own).upper() - range(own).lower()) / 2 : kInfinity;
  });
  if (!radii.allFinite()) return unknown();
  const Numbers middle = stiffness.map([](const Value& own) { return boost::numeric::median(range(own)); });
  const Eigen::LLT<Numbers> factor(middle);
  if (factor.info() != Eigen::Success) return unknown();
  const Numbers lower = factor.matrixL(), inverse = lower.inverse(), transposed = lower.transpose();
  const double s = largest_of(inverse, radii);
  if (!(s < 1)) return unknown();
  Value determinant = stiffness.entries[0][0] * stiffness.cofactor(0, 0);
  for (int j = 1; j < N; ++j) determinant = determinant + stiffness.entries[0][j] * stiffness.cofactor(0, j);
  if (!(range(determinant).lower() > 0)) return unknown();
  EnclosedMatrix<N, Value> compliance;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) compliance.entries[i][j] = stiffness.cofactor(j, i) / determinant;
  const Eigen::SelfAdjointEigenSolver<Numbers> own(middle, Eigen::EigenvaluesOnly);
  Quality all{{}, 1 / ((1 - s) * own.eigenvalues().minCoeff()), (1 + s) * own.eigenvalues().maxCoeff()};
  for (int k = 0; k < kOrders; ++k) {
    const auto of = [k](const Value& value) { return error(value, k); };
    all.errors[k] = std::max(largest_of(inverse, stiffness.map(of)) / (1 - s),
                             largest_of(transposed, compliance.map(of)) * (1 + s));
  }
  return all;
}

template <typename Value>
Quality quality(const MembraneStiffness&, const std::vector<Value>& fields) {
  return quality(EnclosedMatrix<2, Value>{{{{fields[0], fields[1]}, {fields[1], fields[2]}}}});
}

/// σ and ε are multiples of each other on tensors without trace and on those that are all trace.
template <typename Value>
Quality quality(const YoungPoisson& material, const std::vector<Value>& fields) {
  const Value &young = fields[0], &poisson = fields[1];
  const Value one = constant_like(young, 1), two = constant_like(young, 2);
  const bool is_sound = range(young).lower() > 0 && range(poisson).lower() > -1 && range(poisson).upper() < 0.5;
  if (!is_sound) return unknown();
  const Value of_shear = one + poisson,
              of_volume = material.plane == Plane::strain ? of_shear * (one - two * poisson) : one - poisson;
  const Value shear = of_shear / young, volume = of_volume / young;
  const double least = std::min(range(shear).lower(), range(volume).lower());
  if (!(least > 0)) return unknown();
  Quality all{{}, std::max(range(shear).upper(), range(volume).upper()), 1 / least};
  // The inverses from the data: a series that is inverted twice grows twice.
  for (const Value& own : {shear, volume, young / of_shear, young / of_volume})
    for (int k = 0; k < kOrders; ++k) all.errors[k] = std::max(all.errors[k], error(own, k) / range(own).lower());
  return all;
}

template <typename Value>
Quality quality(const HookeTensor&, const std::vector<Value>& fields) {
  const Value root = constant_like(fields[0], std::numbers::sqrt2), two = constant_like(fields[0], 2);
  const Value &xx = fields[0], &xy = fields[1], &yy = fields[3];
  const Value xs = root * fields[2], ys = root * fields[4], ss = two * fields[5];
  return quality(EnclosedMatrix<3, Value>{{{{xx, xy, xs}, {xy, yy, ys}, {xs, ys, ss}}}});
}

std::vector<const Field*> fields_of(const Material& material) {
  if (const auto* membrane = std::get_if<MembraneStiffness>(&material))
    return {&membrane->xx, &membrane->xy, &membrane->yy};
  if (const auto* isotropic = std::get_if<YoungPoisson>(&material)) return {&isotropic->young, &isotropic->poisson};
  std::vector<const Field*> fields;
  for (const Field& own : std::get<HookeTensor>(material).entries) fields.push_back(&own);
  return fields;
}

template <typename Value>
Quality quality_of(const Material& material, const std::vector<Value>& fields) {
  return std::visit([&](const auto& own) { return quality(own, fields); }, material);
}

}  // namespace

int LawPiece::degree_of_rule(int of_fields, double tolerance) const {
  for (const int degree : {5, 6, 8, 10, 18})
    if (degree >= 2 * of_fields && error_of_rule(degree, of_fields) <= std::max(tolerance, 1.5 * errors.back())) return degree;
  return 30;
}

std::vector<LawPiece> law_pieces(const Material& material, const std::array<Point, 3>& corners, double tolerance,
                                 CellBudget& budget) {
  const std::vector<const Field*> fields = fields_of(material);
  const AffineMap map(corners);
  std::vector<LawPiece> pieces;
  bool is_undecided = false;
  const auto add = [&](const std::array<Point, 3>& cell, double share, const Quality& own) {
    pieces.push_back({{cell, share, {}}, own.errors, own.softest, own.stiffest});
  };
  const Settled settled = [&](const std::array<Point, 3>& cell, double share) {
    std::vector<Series> series;
    is_undecided = false;
    for (const Field* field : fields) {
      series.push_back(Series(Series::kMost, field->is_constant() ? (*field)(Point::Zero()) : 0));
      if (field->formula()) {
        bool undecided = false;
        series.back() = series_on_triangle(*field->formula(), {map(cell[0]), map(cell[1]), map(cell[2])}, Series::kMost, undecided);
        is_undecided = is_undecided || undecided;
      }
    }
    const Quality own = quality_of(material, series);
    if (!(own.errors[kOrders - 1] * std::sqrt(share) <= tolerance)) return false;
    add(cell, share, own);
    return true;
  };
  const Acceptance accept = [&](const std::vector<TaylorModel>& models, double share, double of_cell) {
    const double own = is_undecided ? std::max(kToleranceOfJumps, tolerance) : tolerance;
    return quality_of(material, models).errors[kOrders - 1] * share <= own * std::sqrt(of_cell);
  };
  for_each_piece(
      fields, corners, accept, budget,
      [&](const TrianglePiece& piece) { add(piece.corners, piece.share, quality_of(material, piece.models)); },
      settled);
  return pieces;
}

namespace {

/// A piece of an elastic body's triangle has thrice the points, of which each takes ten times the work.
CellBudget budget_of_triangle(const Material& material, Progress& progress) {
  return {components(material) == 1 ? 400 : 60, &progress};
}

}  // namespace

LawOnMesh::LawOnMesh(const Material& material, const Mesh& mesh, double tolerance, Progress& progress)
    : material_(material), mesh_(mesh), progress_(progress), tolerance_(tolerance) {
  const int count = is_constant(material) ? 1 : static_cast<int>(mesh.triangles.size());
  const std::vector<const Field*> fields = fields_of(material);
  for (const Field* field : fields)
    if (!field->is_constant() && !field->formula()) {
      unmet_.push_back(field->name() + " is a function that is known in single points only: give a formula");
      whole_.assign(1, {});
      return;
    }
  for (int t = 0; t < count; ++t) {
    if (t % 64 == 0) progress.check();
    // A law that varies so much on a triangle that it would take too many pieces is known less well.
    std::vector<LawPiece> pieces;
    double own_tolerance = tolerance;
    for (;; own_tolerance *= 10) {
      CellBudget budget = budget_of_triangle(material, progress);
      pieces = law_pieces(material, mesh.corners(t), own_tolerance, budget);
      if (budget.cells > 0 || own_tolerance >= 1) break;
    }
    LawPiece whole{pieces.front()};
    for (const LawPiece& own : pieces) {
      for (int k = 0; k < LawPiece::kOrders; ++k) whole.errors[k] = std::max(whole.errors[k], own.errors[k]);
      whole.softest = std::max(whole.softest, own.softest);
      whole.stiffest = std::max(whole.stiffest, own.stiffest);
    }
    if (!std::isfinite(whole.errors.back() + whole.softest + whole.stiffest) && unmet_.empty())
      unmet_.push_back("/material is not known to be positive definite and bounded near " +
                       to_string(mesh.centroid(t)));
    if (pieces.size() > 1) tolerances_.emplace(t, own_tolerance);
    whole_.push_back(std::move(whole));
  }
}

std::vector<LawPiece> LawOnMesh::cut(int t) const {
  const auto found = tolerances_.find(t);
  if (found == tolerances_.end()) return {};
  CellBudget budget = budget_of_triangle(material_, progress_);
  return law_pieces(material_, mesh_.corners(t), found->second, budget);
}

}  // namespace signorini
