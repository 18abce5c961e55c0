#include "system/symmetric_product.hpp"

#include <algorithm>

#include "progress/pace.hpp"

namespace signorini {

Eigen::VectorXd symmetric_product(const Eigen::MatrixXd& s, const Eigen::VectorXd& x, Progress& progress) {
  constexpr Eigen::Index kColumns = 32;
  Eigen::VectorXd product(x.size());
  Pace pace(progress);
  for (Eigen::Index begin = 0; begin < x.size(); begin += kColumns) {
    const Eigen::Index own = std::min(kColumns, x.size() - begin);
    product.segment(begin, own).noalias() = s.middleCols(begin, own).transpose() * x;
    pace.add(static_cast<std::size_t>(own * x.size()));
  }
  return product;
}

}  // namespace signorini
