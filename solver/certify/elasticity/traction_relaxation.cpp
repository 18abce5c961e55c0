#include "certify/elasticity/traction_relaxation.hpp"

#include "certify/displacement/star_relaxation.hpp"
#include "certify/elasticity/johnson_mercier_data.hpp"
#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "fem/per_shape.hpp"
#include "fem/small_matrices.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

constexpr int kLinear = 12;  ///< tractions at both ends of three edges, x and y in turns
constexpr int kFree = JohnsonMercier::kFree, kMacroData = JohnsonMercier::kData, kRows = kLinear + kFree;

/// The data of the macro-element that has linear tractions, by those at the ends of its edges.
Eigen::Matrix<double, kMacroData, kLinear> data_of_linear() {
  Eigen::Matrix<double, kMacroData, kLinear> data = decltype(data)::Zero();
  for (int e = 0; e < 3; ++e)
    for (int end = 0; end < 2; ++end) {
      data.block<2, 2>(6 * e + 2 * end, 4 * e + 2 * end).setIdentity();
      data.block<2, 2>(6 * e + 4, 4 * e + 2 * end).diagonal().setConstant(0.5);
    }
  return data;
}

/// (τ̂, M τ̂') over the reference triangle for any symmetric M on (xx, yy, xy). τ̂: the stresses of linear
/// tractions and those without data; τ̂': those without data, those of all data, and those of the scheme,
/// whose rows are in reference coordinates too.
class TractionProducts {
 public:
  using Products = Eigen::Matrix<double, kRows, Eigen::Dynamic, 0, kRows, kFree + kMacroData + kMaxLocal>;

  explicit TractionProducts(const Spaces& spaces) {
    const JohnsonMercier& element = johnson_mercier();
    const JohnsonMercierRule& rule = johnson_mercier_rule(spaces, 6);
    Eigen::Matrix<double, JohnsonMercier::kStresses, kRows> rows;
    rows << element.from_data * data_of_linear(), element.free;
    Eigen::Matrix<double, JohnsonMercier::kStresses, kFree + kMacroData> columns;
    columns << element.free, element.from_data;
    const auto functions = rule.values.front().stress.cols();
    for (Products& entry : of_entries_) entry.setZero(kRows, kFree + kMacroData + 2 * functions);
    for (int q = 0; q < rule.size(); ++q) {
      const JohnsonMercier::Place& place = rule.places[q];
      Eigen::Matrix<double, 3, kRows> left;
      for (int i = 0; i < kRows; ++i) left.col(i) = JohnsonMercier::stress(place, rows.col(i));
      Eigen::Matrix<double, 3, Eigen::Dynamic> right(3, kFree + kMacroData + 2 * functions);
      for (int i = 0; i < kFree + kMacroData; ++i)
        right.col(i) = JohnsonMercier::stress(place, columns.col(i));
      for (Eigen::Index a = 0; a < functions; ++a) {
        const Vector tau = rule.values[q].stress.col(a);
        right.middleCols<2>(kFree + kMacroData + 2 * a) << tau.x(), 0, 0, tau.y(), tau.y() / 2, tau.x() / 2;
      }
      int entry = 0;
      for (int a = 0; a < 3; ++a)
        for (int b = a; b < 3; ++b, ++entry) {
          of_entries_[entry] += place.weight * left.row(a).transpose() * right.row(b);
          if (a != b) of_entries_[entry] += place.weight * left.row(b).transpose() * right.row(a);
        }
    }
  }

  Products operator()(const Eigen::Matrix3d& m) const {
    Products sum = m(0, 0) * of_entries_[0];
    int entry = 1;
    for (int b = 1; b < 3; ++b) sum += m(0, b) * of_entries_[entry++];
    for (int b = 1; b < 3; ++b) sum += m(1, b) * of_entries_[entry++];
    return sum + m(2, 2) * of_entries_[entry];
  }

 private:
  std::array<Products, 6> of_entries_;  ///< of M: xx, xy, xz, yy, yz, zz
};

const TractionProducts& traction_products(const Spaces& spaces) {
  static const std::array<TractionProducts, 2> all{TractionProducts(spaces_of(Scheme::nonconforming, 2)),
                                                   TractionProducts(spaces_of(Scheme::conforming, 2))};
  return all[spaces.order];
}

/// The linear tractions, as data, by (ψ, ∇ψ) at the corners and the turns of the edges.
Eigen::Matrix<double, kLinear, TriangleForms::kLocal> linear_of_airy(const AffineMap& map,
                                                                     const std::array<Point, 3>& corners) {
  Eigen::Matrix<double, kLinear, TriangleForms::kLocal> linear = decltype(linear)::Zero();
  const Eigen::Matrix2d inverse = map.jacobian.inverse();
  for (int e = 0; e < 3; ++e) {
    const int from = (e + 1) % 3, to = (e + 2) % 3;
    const Vector way = corners[to] - corners[from];
    const auto take = [&](int column, const Eigen::Matrix2d& ends) {
      linear.block<4, 1>(4 * e, column) = (way.norm() * inverse * ends).reshaped();
    };
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k);
      const ContactPressure::Airy airy{unit[0], unit.tail<2>()};
      take(3 * from + k, EdgeTractions::of_airy(airy, {}, way));
      take(3 * to + k, EdgeTractions::of_airy({}, airy, way));
    }
    take(9 + e, EdgeTractions::of_turn(way));
  }
  return linear;
}

/// The mean of C over the triangle: it decides how far the tractions are relaxed, not whether they balance.
Eigen::Matrix3d mean_compliance(const AffineMap& map, bool is_constant, LawField<2>& law) {
  const auto at = [&](const Point& x) { return SymmetricLaw(law(map(x)).compliance).compliance; };
  if (is_constant) return at({0, 0});
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (int q = 0; q < TriangleRule::size; ++q)
    mean += 2 * triangle_rule().weights[q] * at(triangle_rule().points[q]);
  return mean;
}

/// What the triangles of one shape and law have in common.
struct TractionShape {
  TriangleForms::Matrix matrix;
  /// The slope, by the data of σ* and the coefficients of σ_h in reference coordinates.
  Eigen::Matrix<double, TriangleForms::kLocal, Eigen::Dynamic, 0, TriangleForms::kLocal,
                kMacroData + kMaxLocal>
      slope;
  Eigen::Matrix2d to_reference;
  int number = -1;
};

/// The stresses without data follow as it costs least.
TractionShape traction_shape_of(const Discretization& discrete, int t, LawField<2>& law) {
  const auto corners = discrete.mesh.corners(t);
  const AffineMap map(corners);
  const Eigen::Matrix3d to_triangle = piola(map);
  const TractionProducts::Products products = traction_products(discrete.spaces())(
      map.determinant * to_triangle.transpose() *
      mean_compliance(map, discrete.element.has_constant_material(), law) * to_triangle);
  const auto airy = linear_of_airy(map, corners);
  const Eigen::Matrix<double, kLinear, kFree> of_free = products.topLeftCorner<kLinear, kFree>();
  const Eigen::Matrix<double, kFree, kLinear> follows =
      solve_definite(products.bottomLeftCorner<kFree, kFree>(), of_free.transpose());
  const auto given = products.rightCols(products.cols() - kFree);
  const auto all =
      (airy.transpose() * (given.topRows<kLinear>() - follows.transpose() * given.bottomRows<kFree>()))
          .eval();
  return {all.leftCols<kMacroData>() * data_of_linear() * airy, all, map.jacobian.inverse()};
}

TriangleForms forms_on(const Discretization& discrete, const Eigen::MatrixXd& stress,
                       const EdgeTractions& tractions, Part part, Progress& progress) {
  TriangleForms forms;
  LawField<2> law(discrete.problem.material);
  PerShape<TractionShape> shapes(discrete);
  Eigen::VectorXd given(kMacroData + stress.rows());
  for (int t = part.begin; t < part.end; ++t) {
    progress.check_in(t);
    TractionShape& shape = shapes(t, [&] { return traction_shape_of(discrete, t, law); });
    if (shape.number < 0) shape.number = forms.keep(shape.matrix);
    given << johnson_mercier_data(discrete, tractions, t, AffineMap(discrete.mesh.corners(t))),
        -(shape.to_reference * stress.col(t).reshaped(2, stress.rows() / 2)).reshaped();
    forms.matrix_of.push_back(shape.number);
    forms.slopes.push_back(shape.slope * given);
  }
  return forms;
}

TriangleForms forms_of(const Discretization& discrete, const Eigen::MatrixXd& stress,
                       const EdgeTractions& tractions, Progress& progress) {
  TriangleForms forms{3, 1, true, {}, {}, {}, {}};
  forms.matrix_of.reserve(discrete.triangles());
  forms.slopes.reserve(discrete.triangles());
  in_parts(
      discrete.triangles(), progress,
      [&](Part part, Progress& own) { return forms_on(discrete, stress, tractions, part, own); },
      [&](TriangleForms own) { forms.append(std::move(own)); });
  return forms;
}

/// Tractions stay on all of the boundary but Γ_D.
void hold(const Discretization& discrete, TriangleForms& forms) {
  const Mesh& mesh = discrete.mesh;
  forms.held.assign(forms.unknowns(mesh), false);
  std::vector<bool> is_fixed(mesh.edges.size(), false);
  for (const BoundaryPart& part : mesh.boundary)
    if (condition_on<Fixed>(discrete.problem, part.name))
      for (const int edge : part.edges) is_fixed[edge] = true;
  for (int edge = 0; edge < static_cast<int>(mesh.edges.size()); ++edge) {
    if (mesh.edge_triangles[edge][1] >= 0 || is_fixed[edge]) continue;
    forms.held[forms.of_edge(mesh, edge)] = true;
    for (const int point : mesh.edges[edge])
      for (int k = 0; k < forms.per_point; ++k) forms.held[forms.of_point(point) + k] = true;
  }
}

}  // namespace

void relax_tractions(const Discretization& discrete, const Eigen::MatrixXd& stress, EdgeTractions& tractions,
                     int sweeps, Progress& progress) {
  TriangleForms forms = forms_of(discrete, stress, tractions, progress);
  hold(discrete, forms);
  const Eigen::VectorXd x = relax_stars(discrete.mesh, forms, sweeps, progress);
  const auto points = static_cast<Eigen::Index>(discrete.mesh.points.size());
  tractions.add(x.head(3 * points).reshaped(3, points), x.tail(x.size() - 3 * points));
}

}  // namespace signorini
