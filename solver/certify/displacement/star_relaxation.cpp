#include "certify/displacement/star_relaxation.hpp"

#include <algorithm>
#include <span>

#include <boost/container_hash/hash.hpp>

#include <Eigen/Cholesky>

#include "mesh/triangles_at_points.hpp"
#include "progress/pace.hpp"

namespace signorini {
namespace {

using Matrix = TriangleForms::Matrix;
using FormVector = TriangleForms::Vector;

/// The unknowns of a triangle's functions, and their signs.
struct Place {
  std::array<int, TriangleForms::kLocal> unknowns;
  std::array<double, 3> edge_signs;
};

/// The matrix of a star, factored. On a mesh of squares of one material most stars have the same.
struct StarFactor {
  /// Of its triangles the matrices, the rows that their functions have in the star, and their signs.
  std::vector<int> description;
  Eigen::LLT<Eigen::MatrixXd> factor;
};

class Stars {
 public:
  Stars(const Mesh& mesh, const TriangleForms& forms, Progress& progress)
      : mesh_(mesh),
        forms_(forms),
        pace_(progress),
        triangles_(mesh),
        column_(forms.unknowns(mesh), -1),
        x_(Eigen::VectorXd::Zero(forms.unknowns(mesh))) {}

  /// The unknowns around the point become the best; where its triangles are many, those of the point with
  /// those between so many of them, and then others between so many.
  void relax(int point) {
    const std::span<const int> all = triangles_[point];
    for (std::size_t first = 0; first < all.size(); first += kMost)
      relax(point, all, first, std::min(kMost, all.size() - first));
  }

  Eigen::VectorXd take() { return std::move(x_); }

 private:
  /// Triangles whose edges from the point are relaxed at once: more take their square in memory.
  static constexpr std::size_t kMost = 24;

  void relax(int point, std::span<const int> all, std::size_t first, std::size_t count) {
    own_.clear();
    own_triangles_.clear();
    if (first == 0) take(forms_.of_point(point), forms_.per_point);
    for (const int t : all.subspan(first, count)) take_edges_from(point, t);
    if (own_.empty()) return;
    const auto size = static_cast<Eigen::Index>(own_.size());
    pace_.add(own_.size() * own_.size());
    if (first == 0) own_triangles_.assign(all.begin(), all.end());
    std::ranges::sort(own_triangles_);
    own_triangles_.erase(std::unique(own_triangles_.begin(), own_triangles_.end()), own_triangles_.end());
    places_.clear();
    for (const int t : own_triangles_) places_.push_back(place_of(t));
    const Eigen::LLT<Eigen::MatrixXd>& factor = factor_of(own_triangles_);
    if (factor.info() == Eigen::Success) {
      right_.setZero(size);
      for (std::size_t i = 0; i < places_.size(); ++i) add_slope(own_triangles_[i], places_[i]);
      factor.solveInPlace(right_);
      if (right_.allFinite())
        for (Eigen::Index i = 0; i < size; ++i) x_[own_[i]] += right_[i];
    }
    for (const int unknown : own_) column_[unknown] = -1;
  }

  void take(int first, int count) {
    for (int unknown = first; unknown < first + count; ++unknown)
      if (!forms_.held[unknown] && column_[unknown] < 0) {
        column_[unknown] = static_cast<int>(own_.size());
        own_.push_back(unknown);
      }
  }

  /// With the triangles on both sides.
  void take_edges_from(int point, int t) {
    for (int e = 0; e < 3; ++e) {
      if (mesh_.triangles[t][e] == point) continue;
      const int edge = mesh_.triangle_edges[t][e];
      take(forms_.of_edge(mesh_, edge), forms_.per_edge);
      for (const int side : mesh_.edge_triangles[edge])
        if (side >= 0) own_triangles_.push_back(side);
    }
  }

  Place place_of(int t) const {
    Place place;
    int i = 0;
    for (const int point : mesh_.triangles[t])
      for (int k = 0; k < forms_.per_point; ++k) place.unknowns[i++] = forms_.of_point(point) + k;
    for (int e = 0; e < 3; ++e) {
      const int edge = mesh_.triangle_edges[t][e];
      for (int k = 0; k < forms_.per_edge; ++k) place.unknowns[i++] = forms_.of_edge(mesh_, edge) + k;
      const bool backwards = mesh_.triangles[t][(e + 1) % 3] != mesh_.edges[edge][0];
      place.edge_signs[e] = forms_.edges_are_odd && backwards ? -1 : 1;
    }
    return place;
  }

  double sign(const Place& place, int i) const {
    const int of_points = 3 * forms_.per_point;
    return i < of_points ? 1 : place.edge_signs[(i - of_points) / forms_.per_edge];
  }

  const Eigen::LLT<Eigen::MatrixXd>& factor_of(const std::vector<int>& triangles) {
    constexpr std::size_t of_triangle = 1 + TriangleForms::kLocal + 3;
    description_.resize(of_triangle * places_.size());
    auto next = description_.begin();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      *next++ = forms_.matrix_of[triangles[i]];
      for (const int unknown : places_[i].unknowns) *next++ = column_[unknown];
      for (const double sign : places_[i].edge_signs) *next++ = sign < 0;
    }
    // Mostly that of the point before.
    if (last_->description == description_) return last_->factor;
    last_ = &known_[boost::hash_range(description_.begin(), description_.end()) % known_.size()];
    if (last_->description == description_) return last_->factor;
    last_->description = description_;
    matrix_.setZero(static_cast<Eigen::Index>(own_.size()), static_cast<Eigen::Index>(own_.size()));
    for (std::size_t i = 0; i < places_.size(); ++i) add_matrix(triangles[i], places_[i]);
    last_->factor.compute(matrix_);
    return last_->factor;
  }

  void add_matrix(int t, const Place& place) {
    const Matrix& matrix = forms_.matrices[forms_.matrix_of[t]];
    for (int i = 0; i < TriangleForms::kLocal; ++i) {
      const int row = column_[place.unknowns[i]];
      if (row < 0) continue;
      for (int j = 0; j < TriangleForms::kLocal; ++j) {
        const int column = column_[place.unknowns[j]];
        if (column >= 0) matrix_(row, column) += sign(place, i) * sign(place, j) * matrix(i, j);
      }
    }
  }

  void add_slope(int t, const Place& place) {
    const Matrix& matrix = forms_.matrices[forms_.matrix_of[t]];
    FormVector x;
    for (int i = 0; i < x.size(); ++i) x[i] = sign(place, i) * x_[place.unknowns[i]];
    for (int i = 0; i < x.size(); ++i)
      if (const int row = column_[place.unknowns[i]]; row >= 0)
        right_[row] -= sign(place, i) * (forms_.slopes[t][i] + matrix.col(i).dot(x));
  }

  const Mesh& mesh_;
  const TriangleForms& forms_;
  Pace pace_;
  const TrianglesAtPoints triangles_;
  std::vector<int> column_;         ///< of each unknown in the star's matrix, or -1
  std::vector<int> own_;            ///< the unknowns of the star, or of a part of it
  std::vector<int> own_triangles_;  ///< those that know one of them
  std::vector<Place> places_;       ///< of these triangles' functions
  std::vector<int> description_;
  std::array<StarFactor, 64> known_;
  StarFactor* last_ = &known_[0];
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_, x_;
};

}  // namespace

Eigen::VectorXd relax_stars(const Mesh& mesh, const TriangleForms& forms, int sweeps, Progress& progress) {
  Stars stars(mesh, forms, progress);
  const int points = static_cast<int>(mesh.points.size());
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (int i = 0; i < points; ++i) stars.relax(sweep % 2 == 0 ? i : points - 1 - i);
  return stars.take();
}

}  // namespace signorini
