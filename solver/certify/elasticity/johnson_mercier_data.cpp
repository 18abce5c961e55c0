#include "certify/elasticity/johnson_mercier_data.hpp"

#include "certify/data/balanced_load.hpp"

namespace signorini {

Eigen::Matrix<double, 6, 1> traction_data(const AffineMap& map, int e,
                                          const Eigen::Matrix<double, 2, 3>& traction) {
  const std::array<Point, 3> corners{Point(0, 0), Point(1, 0), Point(0, 1)};
  const double length = (map.jacobian * (corners[(e + 2) % 3] - corners[(e + 1) % 3])).norm();
  return (map.jacobian.inverse() * traction * length).reshaped();
}

JohnsonMercierData johnson_mercier_data(const Discretization& discrete, const EdgeTractions& tractions, int t,
                                        const AffineMap& map) {
  JohnsonMercierData data;
  for (int e = 0; e < 3; ++e) data.segment<6>(6 * e) = traction_data(map, e, tractions.on(t, e));
  data.tail<12>() = (-map.determinant * map.jacobian.inverse() * balanced_load<2>(discrete, t)).reshaped();
  return data;
}

}  // namespace signorini
