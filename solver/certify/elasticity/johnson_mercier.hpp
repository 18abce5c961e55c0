#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "certify/local_fields.hpp"

namespace signorini {

/// The triangle (0,0), (1,0), (0,1) cut into three by its centroid (Alfeld split): part k lies at edge k.
///
/// On it live symmetric stresses that are quadratic on each part, with continuous traction: the element of
/// Johnson and Mercier (1978) in its quadratic form (Gong, Gopalakrishnan, Guzmán, Neilan 2023). To these
/// come the cubic bubbles λ_i λ_j λ_m t tᵀ, with t along the edge between corners i and j, which have no
/// traction on the boundary and whose divergences, with those of the quadratic ones, are all quadratic loads
/// without force and moment (Hu, Zhang 2015); m is i or j, for with the third the three add up to a quadratic
/// one. Such a stress is determined by its traction on the three edges and its divergence up to three
/// stresses that have neither. Displacements on it are quadratic on each part and continuous (the pair of
/// Scott and Vogelius, which is stable here): ten nodes, the corners, the middles of the edges, the centroid,
/// and the middles between corner i and the centroid.
struct JohnsonMercier {
  static constexpr int kPieces = 54;  ///< per part, per node of P2, (xx, yy, xy)
  static constexpr int kBubbles = 6;  ///< per edge, m = i, j
  static constexpr int kStresses = kPieces + kBubbles;
  /// Traction at both ends and in the middle of edge 0, 1, 2; divergence at the nodes of P2.
  static constexpr int kTractions = 18, kData = kTractions + 12;
  static constexpr int kFree = 3;
  static constexpr int kNodes = 10;

  using FromData = Eigen::Matrix<double, kStresses, kData>;
  using Free = Eigen::Matrix<double, kStresses, kFree>;

  /// A stress with the given data, whose tractions are quadratic on the edges and whose divergence is
  /// quadratic on the triangle. The traction is one per unit of the edge's parameter: τ n |e|. The data must
  /// balance: in force and in moment.
  FromData from_data;
  /// The stresses without traction and divergence.
  Free free;

  /// Where values are wanted.
  struct Place {
    Point point;
    double weight;  ///< all weights sum to 1/2
    int part;
    Eigen::Matrix<double, 6, 1> piece_basis;  ///< at the nodes of the part
    Eigen::Matrix<double, 3, kBubbles> bubbles;
    Eigen::Matrix<double, 2, kNodes> displacement_gradients;
    Eigen::Matrix<double, kNodes, 1> displacement_basis;
  };

  /// The points of the rule on each part; and on each part of what a triangle, in the reference coordinates,
  /// has there.
  static std::vector<Place> places(const std::vector<WeightedPoint>& rule);
  static std::vector<Place> places(const std::vector<WeightedPoint>& rule,
                                   const std::array<Point, 3>& triangle);

  /// (xx, yy, xy) of the stress with the given coefficients.
  static Eigen::Vector3d stress(const Place& place,
                                const Eigen::Ref<const Eigen::Vector<double, kStresses>>& coefficients);

  /// The node with the given number.
  static Point node(int number);
};

const JohnsonMercier& johnson_mercier();

}  // namespace signorini
