#include "certify/gap_estimate.hpp"

#include <Eigen/LU>

#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// Not the centroid, in which the gradient of v is better than elsewhere, nor the edges, on which the law may
/// jump.
const std::vector<Point> kPoints{Point(1. / 6, 1. / 6), Point(2. / 3, 1. / 6), Point(1. / 6, 2. / 3)};

template <int D>
Tensor<D> symmetric(Tensor<D> tensor) {
  if constexpr (D == 2) tensor[1] = tensor[2] = (tensor[1] + tensor[2]) / 2;
  return tensor;
}

template <int D>
double estimate(const Discretization& discrete, const Eigen::MatrixXd& stress,
                const AdmissibleDisplacement& v, Progress& progress) {
  struct Squares {
    double gap = 0, size = 0;
  };
  const StressValues<D> values(discrete.spaces(), kPoints);
  const auto find = [&](Part part, Progress& own) {
    Squares found;
    LawField<D> law(discrete.problem.material);
    for (int t = part.begin; t < part.end; ++t) {
      own.check_in(t);
      const AffineMap map(discrete.mesh.corners(t));
      const Eigen::Matrix2d inverse = map.jacobian.inverse();
      const Quadratic<D> displacement = v.on<D>(t);
      for (std::size_t q = 0; q < kPoints.size(); ++q) {
        const auto& [compliance, stiffness] = law(map(kPoints[q]));
        const Tensor<D> sigma = symmetric<D>(values(static_cast<int>(q), map, stress.col(t))),
                        strain = symmetric<D>(
                            gradient<D>(inverse, displacement * quadratic_gradients(kPoints[q]).transpose())),
                        difference = compliance * sigma - strain;
        found.gap += map.determinant * difference.dot(stiffness * difference);
        found.size += map.determinant * sigma.dot(compliance * sigma);
      }
    }
    return found;
  };
  Squares all;
  in_parts(discrete.triangles(), progress, find, [&](const Squares& found) {
    all.gap += found.gap;
    all.size += found.size;
  });
  return all.size > 0 ? all.gap / all.size : 1;
}

}  // namespace

double estimate_gap(const Discretization& discrete, const Eigen::MatrixXd& stress,
                    const AdmissibleDisplacement& v, Progress& progress) {
  return discrete.spaces().components == 1 ? estimate<1>(discrete, stress, v, progress)
                                           : estimate<2>(discrete, stress, v, progress);
}

}  // namespace signorini
