#include "certify/mark.hpp"

#include <algorithm>
#include <numeric>

namespace signorini {

std::vector<int> mark(const Eigen::VectorXd& squares, double bulk) {
  std::vector<int> triangles(squares.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  std::ranges::stable_sort(triangles, std::greater(), [&](int t) { return squares[t]; });
  const double wanted = bulk * squares.sum();
  std::size_t marked = 0;
  for (double sum = 0; sum < wanted && marked < triangles.size(); ++marked) sum += squares[triangles[marked]];
  triangles.resize(marked);
  return triangles;
}

}  // namespace signorini
