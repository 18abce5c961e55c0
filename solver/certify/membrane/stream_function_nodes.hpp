#pragma once

#include "certify/pressure/contact_pressure.hpp"

namespace signorini {

/// The nodes, points and middles of edges, of the quadratic functions that vanish on Γ_F.
class StreamFunctionNodes {
 public:
  explicit StreamFunctionNodes(const Discretization& discrete);
  /// Of those that vanish besides beyond a few layers of triangles around where the stream function of the
  /// pressure does not.
  StreamFunctionNodes(const Discretization& discrete, const ContactPressure& pressure);

  int size() const { return size_; }
  /// The triangles on which not all of the functions vanish.
  const std::vector<int>& triangles() const { return triangles_; }

  /// The number of the node, or -1 where the functions are 0.
  int at_point(int point) const { return numbers_[point]; }
  int at_middle(int edge) const { return numbers_[mesh_.points.size() + edge]; }
  /// Those of a triangle, in the order of Quadratic.
  std::array<int, 6> on(int t) const;

 private:
  /// `layers`: of every point, how many triangles lie between it and where the stream function does not
  /// vanish.
  StreamFunctionNodes(const Discretization& discrete, const std::vector<int>& layers);
  void take(int t, const std::vector<int>& layers);
  void leave_out_traction(const Problem& problem);

  const Mesh& mesh_;
  std::vector<int> triangles_;
  std::vector<int> numbers_;  ///< of the points, then of the edges
  int size_ = 0;
};

}  // namespace signorini
