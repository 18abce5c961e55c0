#include "certify/data/law_quality.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "fem/small_matrices.hpp"
#include "problem/fields.hpp"

namespace signorini {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

constexpr int kOrders = LawQuality::kOrders;
using Errors = std::array<double, kOrders>;

LawQuality unknown() {
  Errors errors;
  errors.fill(kInfinity);
  return {errors, kInfinity, kInfinity};
}

/// Both are true.
LawQuality best_of(LawQuality one, const LawQuality& other) {
  for (int k = 0; k < kOrders; ++k) one.errors[k] = std::min(one.errors[k], other.errors[k]);
  one.softest = std::min(one.softest, other.softest);
  one.stiffest = std::min(one.stiffest, other.stiffest);
  return one;
}

/// What is near a polynomial is near one of a higher degree too.
LawQuality with_least_errors(LawQuality own) {
  for (int k = 1; k < kOrders; ++k) own.errors[k] = std::min(own.errors[k], own.errors[k - 1]);
  return own;
}

bool is_isotropic(const MembraneStiffness& material) {
  const auto& [xx, xy, yy] = material;
  return xy.is_constant() && xy(Point::Zero()) == 0 && xx.formula() && xx.formula() == yy.formula();
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
Value operator*(double factor, const Value& a) {
  return constant_like(a, factor) * a;
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

  /// T A Tᵀ: what the entries have in common stays so.
  EnclosedMatrix congruent(const Numbers& t) const {
    EnclosedMatrix all;
    for (int i = 0; i < N; ++i)
      for (int j = i; j < N; ++j) {
        Value sum = constant_like(entries[0][0], 0);
        for (int k = 0; k < N; ++k)
          for (int l = k; l < N; ++l) {
            const double factor = k == l ? t(i, k) * t(j, k) : t(i, k) * t(j, l) + t(i, l) * t(j, k);
            if (factor != 0) sum = sum + factor * entries[k][l];
          }
        all.entries[i][j] = all.entries[j][i] = sum;
      }
    return all;
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

  /// Nothing where its determinant is not known to be positive.
  std::optional<EnclosedMatrix> inverse() const {
    Value determinant = entries[0][0] * cofactor(0, 0);
    for (int j = 1; j < N; ++j) determinant = determinant + entries[0][j] * cofactor(0, j);
    if (!(range(determinant).lower() > 0)) return std::nullopt;
    EnclosedMatrix all;
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N; ++j)
        all.entries[i][j] =
            i == j ? constant_like(determinant, 1) / schur_complement(i) : cofactor(j, i) / determinant;
    return all;
  }

 private:
  /// What is left of a diagonal entry if the others are eliminated: of a diagonal matrix the entry itself.
  /// The determinant over the cofactor is the same, but has it several times, and enclosures forget that it
  /// is one.
  Value schur_complement(int i) const {
    const Value& own = entries[i][i];
    if constexpr (N == 2) {
      return own - entries[0][1] * entries[0][1] / entries[1 - i][1 - i];
    } else {
      const int a = (i + 1) % 3, b = (i + 2) % 3;
      const Value &to_a = entries[i][a], &to_b = entries[i][b], &between = entries[a][b];
      return own - (to_a * (to_a * entries[b][b] - 2. * between * to_b) + to_b * to_b * entries[a][a]) /
                       cofactor(i, i);
    }
  }
};

template <typename Numbers>
double largest_row(const Numbers& entries) {
  return entries.allFinite() ? entries.cwiseAbs().rowwise().sum().maxCoeff() : kInfinity;
}

/// The middles of the values, and how far they are from them.
template <int N, typename Value>
Eigen::Matrix<double, N, N> middle_of(const EnclosedMatrix<N, Value>& matrix) {
  return matrix.map([](const Value& own) { return boost::numeric::median(range(own)); });
}
template <int N, typename Value>
double radius_of(const EnclosedMatrix<N, Value>& matrix) {
  return largest_row(matrix.map([](const Value& own) {
    return signorini::is_known(range(own)) ? (range(own).upper() - range(own).lower()) / 2 : kInfinity;
  }));
}

/// All eigenvalues of the matrices that are enclosed.
struct EnclosedSpectrum {
  double lowest = kInfinity, highest = -kInfinity;

  template <int N, typename Value>
  void add(const EnclosedMatrix<N, Value>& matrix) {
    const Eigen::VectorXd own = eigenvalues(middle_of(matrix));
    const double radius = radius_of(matrix);
    lowest = std::min(lowest, own[0] - radius);
    highest = std::max(highest, own[N - 1] + radius);
  }
};

/// N = T E Tᵀ and its inverse against polynomials, relative to what they are at least.
template <int N, typename Value>
Errors errors_of(const EnclosedMatrix<N, Value>& relative, const EnclosedSpectrum& spectrum) {
  const std::optional<EnclosedMatrix<N, Value>> inverse = relative.inverse();
  Errors errors = unknown().errors;
  for (int k = 0; inverse && k < kOrders; ++k) {
    const auto of = [k](const Value& value) { return error(value, k); };
    errors[k] = std::max(largest_row(relative.map(of)) / spectrum.lowest,
                         largest_row(inverse->map(of)) * spectrum.highest);
  }
  return errors;
}

/// All is compared with the middle M = (Tᵀ T)⁻¹ of the enclosed values: T E Tᵀ is about 1, whatever the sizes
/// of the entries of E, and where they have a factor in common a multiple of 1.
template <int N>
LawQuality quality(const std::optional<EnclosedMatrix<N, Series>>& series,
                   const std::vector<EnclosedMatrix<N, TaylorModel>>& branches) {
  using Numbers = Eigen::Matrix<double, N, N>;
  Numbers middle = Numbers::Zero(), largest_entries = Numbers::Zero();
  const auto look_at = [&](const auto& matrix, double share) {
    middle += share * middle_of(matrix);
    largest_entries =
        largest_entries.cwiseMax(matrix.map([](const auto& own) { return largest(range(own)); }));
  };
  for (const auto& own : branches) look_at(own, 1. / static_cast<double>(branches.size()));
  if (branches.empty()) look_at(*series, 1);
  const Eigen::LLT<Numbers> factor(middle);
  if (!largest_entries.allFinite() || factor.info() != Eigen::Success) return unknown();
  const Numbers t = Numbers(factor.matrixL()).inverse();

  EnclosedSpectrum spectrum;
  std::vector<EnclosedMatrix<N, TaylorModel>> relative;
  for (const auto& own : branches) relative.push_back(own.congruent(t));
  for (const auto& own : relative) spectrum.add(own);
  std::optional<EnclosedMatrix<N, Series>> relative_series;
  if (series) relative_series = series->congruent(t);
  if (branches.empty()) spectrum.add(*relative_series);
  const double rounding =
      kEnclosureRounding * largest_row(Numbers(t.cwiseAbs() * largest_entries * t.cwiseAbs().transpose()));
  spectrum.lowest -= rounding;
  spectrum.highest += rounding;
  if (!(spectrum.lowest > 0)) return unknown();

  const double softest = eigenvalues(t.transpose() * t)[N - 1], stiffest = eigenvalues(middle)[N - 1];
  LawQuality all{unknown().errors, softest / spectrum.lowest, spectrum.highest * stiffest};
  // Against 0, and against the constant in the middle.
  all.errors.fill((spectrum.highest / spectrum.lowest - 1) / 2);
  all.errors[0] = spectrum.highest / spectrum.lowest;
  const auto take = [&](const Errors& errors) { all = best_of(all, {errors, all.softest, all.stiffest}); };
  if (relative.size() == 1) take(errors_of(relative[0], spectrum));
  if (relative_series) {
    for (int i = 0; i < N; ++i)
      for (int j = 0; j < N && relative.size() == 1; ++j) {
        Series& own = relative_series->entries[i][j];
        own[0] = intersection(range(own), range(relative[0].entries[i][j]));
      }
    take(errors_of(*relative_series, spectrum));
  }
  return with_least_errors(all);
}

template <int N, typename Matrix>
LawQuality quality(const EnclosedFields& fields, const Matrix& matrix_of) {
  std::optional<EnclosedMatrix<N, Series>> series;
  if (!fields.series.empty()) series = matrix_of(fields.series);
  std::vector<EnclosedMatrix<N, TaylorModel>> branches;
  for (const Models& own : fields.branches) branches.push_back(matrix_of(own));
  return quality(series, branches);
}

LawQuality quality(const HookeTensor&, const EnclosedFields& fields) {
  return quality<3>(fields, []<typename Value>(const std::vector<Value>& own) -> EnclosedMatrix<3, Value> {
    const Value &xx = own[0], &xy = own[1], &yy = own[3];
    const Value xs = std::numbers::sqrt2 * own[2], ys = std::numbers::sqrt2 * own[4], ss = 2. * own[5];
    return {{{{xx, xy, xs}, {xy, yy, ys}, {xs, ys, ss}}}};
  });
}

/// Whatever branch it is that a point lies on.
Models hull_of(const std::vector<Models>& branches) {
  Models models = branches[0];
  for (const Models& other : branches)
    for (std::size_t i = 0; branches.size() > 1 && i < models.size(); ++i)
      models[i] = hull(models[i], other[i]);
  return models;
}

/// E = κ 1.
template <typename Value>
LawQuality multiple_of_unity(const Value& stiffness) {
  const Interval& own = range(stiffness);
  if (!(own.lower() > 0)) return unknown();
  const Value compliance = constant_like(stiffness, 1) / stiffness;
  LawQuality all{{}, 1 / own.lower(), own.upper()};
  const double spread = own.upper() / own.lower();
  for (int k = 0; k < kOrders; ++k)
    // Against 0, and against the constant in the middle, of κ and of 1/κ alike.
    all.errors[k] = std::min(k == 0 ? spread : (spread - 1) / 2,
                             std::max(error(stiffness, k) / own.lower(), error(compliance, k) * own.upper()));
  return with_least_errors(all);
}

LawQuality quality(const MembraneStiffness& material, const EnclosedFields& fields) {
  if (!is_isotropic(material))
    return quality<2>(fields, []<typename Value>(const std::vector<Value>& own) -> EnclosedMatrix<2, Value> {
      return {{{{own[0], own[1]}, {own[1], own[2]}}}};
    });
  LawQuality all = unknown();
  if (!fields.series.empty()) all = multiple_of_unity(fields.series[0]);
  if (fields.branches.empty()) return all;
  return best_of(all, multiple_of_unity(hull_of(fields.branches)[0]));
}

/// σ and ε are multiples of each other on tensors without trace and on those that are all trace.
template <typename Value>
LawQuality isotropic(const YoungPoisson& material, const std::vector<Value>& fields) {
  const Value &young = fields[0], &poisson = fields[1];
  const Value one = constant_like(young, 1), two = constant_like(young, 2);
  const bool is_sound =
      range(young).lower() > 0 && range(poisson).lower() > -1 && range(poisson).upper() < 0.5;
  if (!is_sound) return unknown();
  const Value of_shear = one + poisson,
              of_volume = material.plane == Plane::strain ? of_shear * (one - two * poisson) : one - poisson;
  const Value shear = of_shear / young, volume = of_volume / young;
  const double least = std::min(range(shear).lower(), range(volume).lower());
  if (!(least > 0)) return unknown();
  LawQuality all{{}, std::max(range(shear).upper(), range(volume).upper()), 1 / least};
  // The inverses from the data: a series that is inverted twice grows twice.
  for (const Value& own : {shear, volume, young / of_shear, young / of_volume})
    for (int k = 0; k < kOrders; ++k)
      all.errors[k] = std::max(all.errors[k], error(own, k) / range(own).lower());
  return all;
}

LawQuality quality(const YoungPoisson& material, const EnclosedFields& fields) {
  LawQuality all = unknown();
  if (!fields.series.empty()) all = best_of(all, isotropic(material, fields.series));
  if (fields.branches.empty()) return all;
  return best_of(all, isotropic(material, hull_of(fields.branches)));
}

}  // namespace

std::vector<const Field*> different_fields(const Material& material) {
  const auto* membrane = std::get_if<MembraneStiffness>(&material);
  if (membrane && is_isotropic(*membrane)) return {&membrane->xx};
  return fields_of(material);
}

std::vector<Series> series_of(const std::vector<const Field*>& fields, const std::array<Point, 3>& corners) {
  bool is_undecided = false;
  for (const Field* field : fields) {
    if (!field->formula()) continue;
    // The derivatives take more work.
    (void)series_on_triangle(*field->formula(), corners, 0, is_undecided);
    if (is_undecided) return {};
  }
  std::vector<Series> series;
  for (const Field* field : fields)
    series.push_back(field->formula()
                         ? series_on_triangle(*field->formula(), corners, Series::kMost, is_undecided)
                         : Series(Series::kMost, (*field)(Point::Zero())));
  return series;
}

LawQuality quality_of(const Material& material, const EnclosedFields& fields) {
  return std::visit([&](const auto& own) { return quality(own, fields); }, material);
}

}  // namespace signorini
