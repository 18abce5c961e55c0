#include "certify/displacement/recovered_displacement.hpp"

#include "certify/local_fields.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// Points of the reference triangle, and a column for each: what its value counts at the three corners in the
/// linear function nearest to the values at all.
struct LinearFit {
  std::vector<Point> points;
  Eigen::Matrix<double, 3, Eigen::Dynamic> weights;
};

/// A strain that is linear is known by the corners.
LinearFit fit_of_strain(const Discretization& discrete) {
  const bool is_linear = discrete.spaces().order == 0 && discrete.element.has_constant_material();
  if (is_linear) return {{{0, 0}, {1, 0}, {0, 1}}, Eigen::Matrix3d::Identity()};
  return {triangle_points(), corner_weights()};
}

template <int D>
class RecoveredDisplacement {
 public:
  RecoveredDisplacement(const Discretization& discrete, const Solution& solution)
      : discrete_(discrete),
        solution_(solution),
        fit_(fit_of_strain(discrete)),
        stress_(discrete.spaces(), fit_.points),
        law_(discrete.problem.material) {}

  /// Column z: the value at corner z.
  Eigen::Matrix<double, D, 3> at_corners(int t) {
    const auto corners = discrete_.mesh.corners(t);
    const Eigen::Matrix<double, 2 * D, 3> slope = gradient_at_corners(t, AffineMap(corners));
    Eigen::Matrix<double, D, 3> rise,
        bend;  // along edge e from corner e + 1 to e + 2: of u, and of its slope
    for (int e = 0; e < 3; ++e) {
      const int a = (e + 1) % 3, b = (e + 2) % 3;
      const Vector edge = corners[b] - corners[a];
      for (int c = 0; c < D; ++c) {
        const auto at_a = slope.template block<2, 1>(2 * c, a), at_b = slope.template block<2, 1>(2 * c, b);
        rise(c, e) = 0.5 * (at_a + at_b).dot(edge);
        bend(c, e) = (at_b - at_a).dot(edge);
      }
    }
    // A gradient rises by nothing around the triangle.
    rise.colwise() -= Eigen::Matrix<double, D, 1>(rise.rowwise().mean());
    Eigen::Matrix<double, D, 3> values;
    values << Eigen::Matrix<double, D, 1>::Zero(), rise.col(2), -rise.col(1);
    // The mean of a quadratic function is that of its values at the middles of the edges.
    const Eigen::Matrix<double, D, 1> mean = values.rowwise().mean() - bend.rowwise().mean() / 8;
    values.colwise() += displacement(t) - mean;
    return values;
  }

  /// Of the triangle that was asked for last, as it resists most of what it may be strained by.
  double stiffness() const { return static_cast<double>(fit_.points.size()) / softness_; }

 private:
  Eigen::Matrix<double, 2 * D, 3> gradient_at_corners(int t, const AffineMap& map) {
    Eigen::Matrix<double, 2 * D, 3> gradient = Eigen::Matrix<double, 2 * D, 3>::Zero();
    softness_ = 0;
    for (int q = 0; q < static_cast<int>(fit_.points.size()); ++q) {
      const TensorMap<D>& compliance = law_(map(fit_.points[q])).compliance;
      gradient += compliance * stress_(q, map, solution_.stress.col(t)) * fit_.weights.col(q).transpose();
      softness_ += compliance.trace();
    }
    if constexpr (D == 2)
      for (int z = 0; z < 3; ++z) {
        const double rotation = solution_.rotation[discrete_.mesh.triangles[t][z]];
        gradient(1, z) += rotation;
        gradient(2, z) -= rotation;
      }
    return gradient;
  }

  Eigen::Matrix<double, D, 1> displacement(int t) const {
    Eigen::Matrix<double, D, 1> mean = Eigen::Matrix<double, D, 1>::Zero();
    const auto u = solution_.displacement.col(t);
    for (int i = 0; i < u.size(); i += D) mean += u.template segment<D>(i);
    return mean * D / u.size();
  }

  const Discretization& discrete_;
  const Solution& solution_;
  const LinearFit fit_;
  StressValues<D> stress_;
  LawField<D> law_;
  double softness_ = 0;
};

/// Stiff triangles count for more: to strain them by what a soft one beside them is off by would cost the
/// more.
template <int D>
Eigen::MatrixXd average(const Discretization& discrete, const Solution& solution, Progress& progress) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(D, discrete.mesh.points.size());
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(discrete.mesh.points.size());
  struct Weighted {
    Part part;
    Eigen::Matrix<double, D, Eigen::Dynamic> corners{D, 3 * (part.end - part.begin)};
    Eigen::VectorXd stiffness{part.end - part.begin};
  };
  const auto find = [&](Part part, Progress& own) {
    RecoveredDisplacement<D> recovered(discrete, solution);
    Weighted found{part};
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      const Eigen::Matrix<double, D, 3> corners = recovered.at_corners(t);
      const Eigen::Index i = t - part.begin;
      found.stiffness[i] = recovered.stiffness();
      found.corners.template middleCols<3>(3 * i) = recovered.stiffness() * corners;
    }
    return found;
  };
  in_parts(discrete.triangles(), progress, find, [&](const Weighted& found) {
    for (int t = found.part.begin; t < found.part.end; ++t)
      for (int z = 0; z < 3; ++z) {
        const int point = discrete.mesh.triangles[t][z];
        const Eigen::Index i = t - found.part.begin;
        values.col(point) += found.corners.col(3 * i + z);
        weights[point] += found.stiffness[i];
      }
  });
  // Points without a triangle have nothing to average.
  for (Eigen::Index p = 0; p < values.cols(); ++p)
    if (weights[p] > 0) values.col(p) /= weights[p];
  return values;
}

}  // namespace

Eigen::MatrixXd displacement_at_corners(const Discretization& discrete, const Solution& solution,
                                        Progress& progress) {
  return discrete.spaces().components == 1 ? average<1>(discrete, solution, progress)
                                           : average<2>(discrete, solution, progress);
}

}  // namespace signorini
