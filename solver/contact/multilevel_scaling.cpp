#include "contact/multilevel_scaling.hpp"

#include <algorithm>
#include <numeric>

#include "progress/pace.hpp"

namespace signorini {
namespace {

/// Each unknown with the free one that it is coupled with most strongly for its size.
std::vector<int> pairs(const Eigen::MatrixXd& s, Progress& progress) {
  Pace pace(progress);
  std::vector<int> pair_of(s.rows(), -1);
  int count = 0;
  for (Eigen::Index i = 0; i < s.rows(); ++i) {
    if (pair_of[i] >= 0) continue;
    pair_of[i] = count;
    pace.add(static_cast<std::size_t>(s.rows() - i));
    Eigen::Index partner = -1;
    double strongest = 0;
    for (Eigen::Index j = i + 1; j < s.rows(); ++j) {
      const double strength = s(j, i) * s(j, i) / s(j, j);
      if (pair_of[j] < 0 && strength > strongest) {
        strongest = strength;
        partner = j;
      }
    }
    if (partner >= 0) pair_of[partner] = count;
    ++count;
  }
  return pair_of;
}

int count_of(const std::vector<int>& aggregate) {
  return *std::max_element(aggregate.begin(), aggregate.end()) + 1;
}

/// Pᵀ S P, with only the open rows and columns of S.
Eigen::MatrixXd coarsen(const Eigen::MatrixXd& s, const std::vector<int>& open,
                        const std::vector<int>& aggregate, Progress& progress) {
  Pace pace(progress);
  const int n = count_of(aggregate);
  Eigen::MatrixXd coarse(n, n);
  for (int j = 0; j < n; ++j) {
    pace.add(static_cast<std::size_t>(n));
    coarse.col(j).setZero();
  }
  for (const int j : open) {
    pace.add(open.size());
    for (const int i : open) coarse(aggregate[i], aggregate[j]) += s(i, j);
  }
  return coarse;
}

std::vector<int> all_of(const Eigen::MatrixXd& s) {
  std::vector<int> all(s.rows());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

Eigen::VectorXd inverse_diagonal(const Eigen::MatrixXd& s) {
  return s.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / d : 0; });
}

}  // namespace

MultilevelScaling::MultilevelScaling(const Eigen::MatrixXd& s, Progress& progress)
    : s_(s), progress_(progress) {
  Eigen::MatrixXd coarser;
  for (const Eigen::MatrixXd* level = &s;; level = &coarser) {
    const std::vector<int> aggregate = pairs(*level, progress_);
    if (count_of(aggregate) == level->rows()) return;
    coarser = coarsen(*level, all_of(*level), aggregate, progress_);
    levels_.push_back({aggregate, {}, Eigen::VectorXd(coarser.rows())});
  }
}

void MultilevelScaling::restrict_to(const std::vector<int>& open) {
  inverse_.setZero(s_.rows());
  for (const int i : open) inverse_[i] = 1 / s_(i, i);
  Eigen::MatrixXd coarser;
  for (std::size_t l = 0; l < levels_.size(); ++l) {
    coarser = l == 0 ? coarsen(s_, open, levels_[l].aggregate, progress_)
                     : coarsen(coarser, all_of(coarser), levels_[l].aggregate, progress_);
    levels_[l].inverse = inverse_diagonal(coarser);
  }
}

void MultilevelScaling::apply(const Eigen::VectorXd& v, Eigen::VectorXd& out) {
  const Eigen::VectorXd* below = &v;
  for (Level& level : levels_) {
    level.restricted.setZero();
    for (std::size_t i = 0; i < level.aggregate.size(); ++i)
      level.restricted[level.aggregate[i]] += (*below)[i];
    below = &level.restricted;
  }
  for (std::size_t l = levels_.size(); l-- > 0;) {
    Level& level = levels_[l];
    level.restricted.array() *= level.inverse.array();
    if (l + 1 == levels_.size()) continue;
    const Level& coarser = levels_[l + 1];
    for (std::size_t i = 0; i < coarser.aggregate.size(); ++i)
      level.restricted[i] += coarser.restricted[coarser.aggregate[i]];
  }
  out = v.cwiseProduct(inverse_);
  if (levels_.empty()) return;
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (inverse_[i] > 0) out[i] += levels_[0].restricted[levels_[0].aggregate[i]];
}

}  // namespace signorini
