#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "fem/scheme.hpp"
#include "mesh/mesh.hpp"
#include "problem/problem.hpp"

namespace signorini {

/// What a factor (system/multifrontal.hpp) takes, in bytes.
struct FactorBytes {
  double panels = 0;  ///< of L
  double fronts = 0;  ///< of the numbers of its unknowns
  double stacks = 0;  ///< of what pieces leave, while it is made
};

/// Squares of a size, each of a few triangles.
struct Grid {
  double x, y;
  double width, height;  ///< of a square
  bool is_regular;       ///< that cuts may go between squares
  double upright;        ///< the part of the contact unknowns on the sides along y
  int kinds;             ///< of squares, two where diagonals alternate: pieces that are alike are kept once
                         ///< (system/repeated_pieces.hpp); 0 where none are, as their materials differ
};

/// From a formula for a dissection of squares.
FactorBytes factor_bytes(const Grid& grid, const Spaces& spaces, double triangles, double contact_unknowns);

/// The pieces into which the dissection cuts a mesh (system/dissection.hpp), which are made for it without
/// any matrix: however long and thin the triangles are, whatever joins them.
class MeshPieces {
 public:
  using Edges = std::vector<std::array<int, 2>>;  ///< as pairs of points

  /// The edges of each condition that there is on the boundary. `alike`: triangles of a shape share their
  /// matrix, so that pieces may be alike (system/repeated_pieces.hpp). A mesh that nobody has checked may
  /// have numbers of points that do not exist: then there are no pieces.
  MeshPieces(const std::vector<Point>& points, std::vector<std::array<int, 3>> triangles,
             const std::vector<std::pair<const Condition*, const Edges*>>& boundary, int components,
             bool alike);

  /// Takes from the same mesh before a uniform refinement how its factor grows by one.
  void grow_as_from(std::shared_ptr<const MeshPieces> coarser) { coarser_ = std::move(coarser); }

  bool empty() const { return pieces_.empty(); }
  double triangles() const { return triangles_; }  ///< of the mesh that was cut

  /// The matrices of the mesh with so many triangles, by uniform refinements.
  double shapes(double triangles) const;

  /// Of the mesh with so many triangles, by uniform refinements or about such, and so many contact unknowns.
  /// `repeated`: of pieces that are alike one is kept.
  FactorBytes factor_bytes(const Spaces& spaces, double triangles, double contact_unknowns,
                           bool repeated) const;

 private:
  /// What lies on a cut, or on the rim of a piece.
  struct Share {
    double traces = 0;   ///< components of the trace that are unknown, on all edges
    double points = 0;   ///< with a rotation
    double contact = 0;  ///< edges
  };
  struct Piece {
    Share cut, rim;
    int parity;  ///< of its depth
    bool is_leaf;
    int original, uses;         ///< the number of the first that is like it, and what takes that in
    std::array<int, 2> halves;  ///< their numbers, unless it is a leaf
    Vector extent;              ///< of a leaf,
    double across;              ///< and by how many times more triangles lie along x than along y
  };
  double worsening(const Spaces& spaces, double contact_unknowns) const;
  double fullness(const Piece& leaf, const Spaces& spaces, double triangles) const;
  FactorBytes within(const Piece& leaf, const Spaces& spaces, double triangles, double contact) const;

  double triangles_, shapes_ = 0, boundary_edges_ = 0, contact_edges_ = 0;
  /// Of one shape, and the same turned round, with two sides along the axes, so that its pieces are alike: it
  /// is one again when it is refined. Of other meshes it is not known.
  bool is_lattice_ = false;
  std::vector<Piece> pieces_;  ///< the halves before the whole
  std::shared_ptr<const MeshPieces> coarser_;
};

}  // namespace signorini
