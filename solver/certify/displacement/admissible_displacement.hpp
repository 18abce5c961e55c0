#pragma once

#include <map>
#include <string>
#include <vector>

#include "certify/displacement/gap_bubble.hpp"
#include "certify/displacement/lift.hpp"
#include "certify/displacement/point_constraints.hpp"
#include "certify/local_fields.hpp"
#include "fem/discretization.hpp"
#include "fem/edge_pieces.hpp"
#include "progress/in_parts.hpp"
#include "result/solution.hpp"

namespace signorini {

/// The gap on a contact edge.
const Field& gap_on(const Discretization& discrete, const ContactEdge& contact);

/// v_h of the certificate: continuous, u_D on Γ_D, v_n ≤ g on Γ_C, v_n = 0 on rollers, and one order better
/// than u_h.
///
/// It is quadratic on every triangle. Its values at the points are those of displacement_at_corners(), made
/// admissible; its mean over each edge is that of the trace multiplier m, so that it inherits the balance of
/// volume ∫ tr C σ_h = ∫ m·n of every triangle. What a boundary value has beyond its quadratic part is lifted
/// into the triangle behind the edge as a polynomial, and what that leaves of u_D by a function of which only
/// a bound is known: LiftRest.
///
/// v_n ≤ g holds for all values that the gap is enclosed by, wherever they lie between the nodes.
class AdmissibleDisplacement {
 public:
  /// `coupling`: the unknowns of the trace space.
  AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                         const Eigen::VectorXd& coupling, Progress& progress);

  /// η of a dual problem, whose gap is w: |w − η_n| ≤ K (g − v_n) + b 4 s (1 − s) on each edge of Γ_C, where
  /// v is the displacement of the base, with the gap g. The factor K is no more than the given one, or than
  /// what is fixed beside a contact needs; b is beyond_base().
  AdmissibleDisplacement(const Discretization& discrete, const Solution& solution,
                         const Eigen::VectorXd& coupling, const AdmissibleDisplacement& base, double factor,
                         Progress& progress);

  /// max |v|, and of what holds it.
  double scale() const { return scale_; }

  /// K of a dual problem.
  double factor() const { return beside_.factor; }
  /// b of a dual problem: 0 but for rounding unless w is neither a polynomial nor smooth on the edge.
  double beyond_base(const ContactEdge& contact) const;

  /// Lowers ½ ‖∇v‖²_E − work(v) of a membrane's displacement, which stays admissible: see relaxation.hpp.
  /// What is lifted stays as it is, and so do the values that touch; of a dual problem all on Γ_C.
  void relax(const Eigen::VectorXd& work, int steps, Progress& progress);

  /// The same for an elastic body, in so many sweeps: see displacement_relaxation.hpp.
  void relax_on_stars(int sweeps, Progress& progress);

  template <int D>
  Quadratic<D> on(int t) const {
    Quadratic<D> values;
    for (int k = 0; k < 3; ++k) {
      values.col(k) = points_.col(discrete_.mesh.triangles[t][k]);
      values.col(3 + k) = middles_.col(discrete_.mesh.triangle_edges[t][k]);
    }
    return values;
  }

  /// Something is lifted into the triangle: v_h is of degree 8 there.
  bool is_lifted(int t) const;

  /// max |z| and max |∇z| of the rest of u_D that is lifted besides, by a function z.
  struct LiftRest {
    double value = 0, slope = 0;
  };
  LiftRest rest_of_lifts(int t) const;

  /// A bound of |v_h| on the triangle, without what is lifted.
  double largest_on(int t) const;

  /// Adds what is lifted into triangle t, and its gradient, at a point of the reference triangle.
  template <int D>
  void add_lifts(int t, const Point& reference, const Eigen::Matrix2d& inverse_jacobian,
                 Eigen::Matrix<double, D, 1>& value, Tensor<D>& slope) const;

  /// The value on an edge at s ∈ [0, 1] from its first to its second point.
  Eigen::VectorXd on_edge(int edge, double s) const;

  /// v_n on a contact edge, and g − v_n.
  double along_contact(const ContactEdge& contact, double s) const;
  double room(const ContactEdge& contact, double s) const;

  /// Where v_n follows the gap, by what multiple of the bubble 4 s (1 − s) it is below; else nothing.
  std::optional<double> off_followed_gap(const ContactEdge& contact) const;

  /// Why v_h is not admissible, in words; empty if it is.
  const std::vector<std::string>& unmet() const { return unmet_; }

 private:
  /// Below this part of the displacement a difference is rounding.
  static constexpr double kSmall = 1e-12;
  /// What is fixed may be off a condition that it meets by so much.
  static constexpr double kNearly = 1e3 * kSmall;
  /// Of all edges on which a gap is enclosed.
  static constexpr int kCellsOfGaps = 20'000;

  AdmissibleDisplacement(const Discretization& discrete, Eigen::MatrixXd points,
                         const Eigen::VectorXd& coupling);

  /// What is lifted from the edge, or null; the edge runs from its first to its second point.
  const Lift* lift(int edge) const;

  using Values = std::function<Eigen::VectorXd(double s)>;

  void set_middles(const Eigen::VectorXd& coupling, Progress& progress);
  void set_middles(const Eigen::VectorXd& coupling, Part part, Progress& progress);
  void constrain_points();
  void fix_points(int edge, const Fixed& fixed);
  void constrain(int point, PointConstraint constraint);
  void constrain_to_gap();
  void constrain_beside_base();
  void admit_points();
  void admit(int point, std::vector<PointConstraint> constraints);
  void meet_supports();
  void follow_traces();
  void find_followed_gaps(Progress& progress);
  /// The clearance is 0 at both ends, and a polynomial is near the gap between them.
  bool follows_gap(const ContactEdge& contact) const;
  bool exceeds_gap(const ContactEdge& contact) const;
  void fix(const BoundaryPart& part, const Fixed& condition);
  void add_rest(int edge, const EdgeLine& line, const Field& field);
  double small_coefficient() const;
  void roll(const BoundaryPart& part, const SupportMotion& motion);
  void lower_points(CellBudget& budget);
  void meet(const ContactEdge& contact, CellBudget& budget);
  void close(const ContactEdge& contact);
  void lower_below(const ContactEdge& contact, CellBudget& budget);
  BelowGap below_gap(const ContactEdge& contact, const EdgeLine& line) const;
  void add_lift(int edge, const Values& d);
  bool touches_base(const ContactEdge& contact, int k) const;
  double meet_base(const ContactEdge& contact, CellBudget& budget);
  std::array<double, 2> bubbles_beyond_base(const ContactEdge& contact, double factor,
                                            CellBudget& budget) const;
  double stay_between_bubbles(const ContactEdge& contact, double factor, CellBudget& budget);
  double follow_base(const ContactEdge& contact, const std::array<double, 2>& ratios);
  void refuse(const std::string& reason);
  void refuse_point(int point);

  const Field& gap(const ContactEdge& contact) const;
  double gap_at(const ContactEdge& contact, double s) const;
  /// The vector with v_n = direction · v on a contact edge.
  Eigen::VectorXd direction(const ContactEdge& contact) const;

  const Discretization& discrete_;
  int components_;
  Eigen::VectorXd clearance_;  ///< a value a row of the clearance space
  Eigen::MatrixXd points_;     ///< a column a point
  Eigen::MatrixXd middles_;    ///< a column an edge
  double scale_;               ///< max |v|
  std::map<int, Eigen::VectorXd> fixed_points_;
  std::map<int, std::vector<PointConstraint>> constraints_;  ///< of contacts and rollers, by points
  std::map<int, double> off_gap_;  ///< of edges that follow their gap: by how much, over the bubble
  std::map<int, Lift> lifts_;
  std::map<int, LiftRest> rests_;  ///< of u_D on edges
  /// Of a dual problem, where there is a base.
  struct BesideBase {
    const AdmissibleDisplacement* base = nullptr;
    double factor = 0;                  ///< K
    std::map<int, double> beyond = {};  ///< b, by edges
  } beside_;
  std::vector<std::string> unmet_;
};

}  // namespace signorini
