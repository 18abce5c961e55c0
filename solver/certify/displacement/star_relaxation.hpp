#pragma once

#include <algorithm>
#include <array>
#include <deque>
#include <iterator>
#include <vector>

#include <Eigen/Core>

#include "mesh/mesh.hpp"
#include "progress/progress.hpp"
#include "system/alike_matrices.hpp"

namespace signorini {

/// ½ x·A x + slope·x as a sum over the triangles of a mesh, each of which knows twelve functions: so many of
/// each of its corners, then so many of each of its edges.
///
/// The unknowns are those of the points of the mesh, then those of its edges.
struct TriangleForms {
  static constexpr int kLocal = 12;
  using Matrix = Eigen::Matrix<double, kLocal, kLocal>;
  using Vector = Eigen::Matrix<double, kLocal, 1>;

  int per_point = 2, per_edge = 2;  ///< 3 (per_point + per_edge) = 12
  /// The functions of an edge change their sign with its direction: a triangle has them for its own, from
  /// corner e + 1 to e + 2, an unknown belongs to that of the edge, from its smaller to its larger point
  /// number.
  bool edges_are_odd = false;
  std::deque<Matrix> matrices;  ///< grows without being copied: it may be most of what a certificate takes
  std::vector<int> matrix_of;   ///< of each triangle; one shape and law may serve many
  std::vector<Vector> slopes;   ///< of each triangle
  std::vector<bool> held;       ///< of each unknown: it stays 0

  Eigen::Index unknowns(const Mesh& mesh) const {
    return static_cast<Eigen::Index>(per_point * mesh.points.size() + per_edge * mesh.edges.size());
  }
  /// Takes a form and answers its number for `matrix_of`.
  int keep(const Matrix& matrix) {
    matrices.push_back(matrix);
    return static_cast<int>(matrices.size()) - 1;
  }
  /// That of one of the last few among `known` that is equal but for rounding, or takes it and adds its
  /// number to them.
  int keep(const Matrix& matrix, std::vector<int>& known) {
    return number_of_alike(
        matrix, known, [this](int own) -> const Matrix& { return matrices[own]; },
        [&] { return keep(matrix); });
  }

  /// Adds those of triangles that come behind.
  void append(TriangleForms&& behind) {
    const int first = static_cast<int>(matrices.size());
    std::ranges::move(behind.matrices, std::back_inserter(matrices));
    for (const int own : behind.matrix_of) matrix_of.push_back(first + own);
    slopes.insert(slopes.end(), behind.slopes.begin(), behind.slopes.end());
  }

  /// The first of the unknowns of a point, of an edge.
  int of_point(int point) const { return per_point * point; }
  int of_edge(const Mesh& mesh, int edge) const {
    return per_point * static_cast<int>(mesh.points.size()) + per_edge * edge;
  }
};

/// Lowers the form from x = 0: point by point, the unknowns of the point and of the edges from it become the
/// best while all others stay, there and back as often as `sweeps` says (block Gauss–Seidel). The form never
/// rises.
///
/// A star holds the local displacements without divergence and the local stresses in equilibrium, so that
/// neither a nearly incompressible body nor a thin triangle takes more sweeps (the decomposition of Farrell,
/// Mitchell, Scott, Wechsung 2021).
Eigen::VectorXd relax_stars(const Mesh& mesh, const TriangleForms& forms, int sweeps, Progress& progress);

}  // namespace signorini
