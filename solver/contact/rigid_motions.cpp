#include "contact/rigid_motions.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "contact/cone.hpp"
#include "fem/rigid_frame.hpp"
#include "fem/small_matrices.hpp"
#include "mesh/bodies.hpp"
#include "progress/observer.hpp"

namespace signorini {
namespace {

using Motions = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< a motion a column

RigidFrame frame_of(const Discretization& discrete, const std::vector<int>& triangles) {
  Point centre(0, 0);
  double area = 0;
  for (const int t : triangles) {
    const double own = 0.5 * AffineMap(discrete.mesh.corners(t)).determinant;
    centre += own * discrete.mesh.centroid(t);
    area += own;
  }
  return {discrete.spaces().components, centre / area, std::sqrt(area)};
}

/// The triangles of a body, and its edges on the boundary that hold it.
struct Body {
  std::vector<int> triangles, fixed, rollers;
  std::vector<const ContactEdge*> contact;
};

/// In one pass: there may be as many bodies as triangles, and as many parts.
std::vector<Body> bodies_of(const Discretization& discrete) {
  std::vector<std::vector<int>> triangles = bodies(discrete.mesh);
  const std::vector<int> body_of = body_of_triangles(triangles, discrete.mesh.triangles.size());
  std::vector<Body> all;
  for (std::vector<int>& own : triangles) all.emplace_back().triangles = std::move(own);
  const auto body_at = [&](int edge) -> Body& { return all[body_of[discrete.mesh.edge_triangles[edge][0]]]; };
  for (const BoundaryPart& part : discrete.mesh.boundary) {
    if (condition_on<Fixed>(discrete.problem, part.name))
      for (const int edge : part.edges) body_at(edge).fixed.push_back(edge);
    if (condition_on<Roller>(discrete.problem, part.name))
      for (const int edge : part.edges) body_at(edge).rollers.push_back(edge);
  }
  for (const ContactEdge& contact : discrete.clearance.edges)
    body_at(contact.edge).contact.push_back(&contact);
  return all;
}

/// One body of the mesh with its rigid motions, its supports and its loads.
class RigidBody {
 public:
  RigidBody(const Discretization& discrete, Body body)
      : frame_(frame_of(discrete, body.triangles)),
        discrete_(discrete),
        body_(std::move(body)),
        components_(discrete.spaces().components) {}

  const RigidFrame& frame() const { return frame_; }

  /// Names the body where there are others.
  std::string name() const {
    if (body_.triangles.size() == discrete_.mesh.triangles.size()) return "the body";
    return "the body around " + pair(frame_.centre());
  }

  Motions all() const {
    return components_ == 1 ? Motions(Eigen::Vector3d::UnitX()) : Motions(Eigen::Matrix3d::Identity());
  }

  std::string name(const RigidMotion& motion) const {
    if (components_ == 1) return "translation";
    const double rotation = motion[2] / frame_.size();
    if (std::abs(motion[2]) < 1e-6 * motion.norm()) {
      const Vector direction =
          motion.head<2>().normalized().unaryExpr([](double c) { return std::abs(c) < 1e-9 ? 0 : c; });
      return "translation along " + pair(direction);
    }
    return "rotation about " + pair(frame_.centre() + Vector(-motion.y(), motion.x()) / rotation);
  }

  /// Calls visit(point) at both ends of each fixed edge.
  template <typename Visit>
  void where_fixed(const Visit& visit) const {
    for (const int edge : body_.fixed)
      for (const int point : discrete_.mesh.edges[edge]) visit(discrete_.mesh.points[point]);
  }

  /// Calls visit(normal, point) at both ends of each edge on rollers.
  template <typename Visit>
  void on_rollers(const Visit& visit) const {
    for (const int edge : body_.rollers)
      for (const int point : discrete_.mesh.edges[edge])
        visit(discrete_.mesh.outward_normal(edge), discrete_.mesh.points[point]);
  }

  /// Calls visit(direction, point, gap) at both ends of each own edge of Γ_C.
  template <typename Visit>
  void at_contact(const Visit& visit) const {
    for (const ContactEdge* contact : body_.contact)
      for (int end = 0; end < 2; ++end)
        visit(contact->direction, discrete_.mesh.points[discrete_.mesh.edges[contact->edge][end]],
              contact->gap[end * discrete_.spaces().order]);
  }

  /// Calls visit(direction, point) in the middle of each own edge of Γ_C, where clearances of order 0 are.
  template <typename Visit>
  void in_middles_of_contact(const Visit& visit) const {
    for (const ContactEdge* contact : body_.contact)
      visit(contact->direction, discrete_.clearance.rows[contact->rows[0]].point);
  }

  /// The work of the loads on each of the three motions, and the sum of the sizes of its terms.
  struct Work {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero(), terms = Eigen::RowVector3d::Zero();
    void add(double force, const Eigen::RowVector3d& motion) {
      sum += force * motion;
      terms += (force * motion).cwiseAbs();
    }
  };
  Work work() const {
    Work work;
    const Mesh& mesh = discrete_.mesh;
    for (const int t : body_.triangles) {
      const LocalVector load = discrete_.load.col(t);
      const auto corners = mesh.corners(t);
      for (int i = 0; i < load.size(); ++i) {
        const Point x = discrete_.spaces().order == 0 ? mesh.centroid(t) : corners[i / components_];
        work.add(load[i], frame_.component(i % components_, x));
      }
      add_traction(t, work);
    }
    add_couples(work);
    return work;
  }

 private:
  /// To six digits.
  static std::string pair(const Vector& v) {
    std::ostringstream text;
    text.precision(6);
    text << '(' << v.x() << ", " << v.y() << ')';
    return text.str();
  }

  void add_traction(int t, Work& work) const {
    const auto corners = discrete_.mesh.corners(t);
    const int per_edge = discrete_.spaces().traces_per_edge();
    for (int j = 0; j < 3 * per_edge; ++j) {
      const int dof = discrete_.traces.dof(t, j), e = j / per_edge, function = j % per_edge / components_;
      if (!discrete_.traces.is_free(dof)) continue;
      const double force = discrete_.coupling_load[discrete_.traces[dof].unknown];
      if (force == 0) continue;
      const Point &a = corners[(e + 1) % 3], &b = corners[(e + 2) % 3];
      const Point x = discrete_.spaces().order == 0 ? Point((a + b) / 2) : (function == 0 ? a : b);
      work.add(force, frame_.component(j % components_, x));
    }
  }

  /// The third motion turns by 1 / size, and γ is minus the rotation.
  void add_couples(Work& work) const {
    if (!discrete_.spaces().leaves_couples()) return;
    std::vector<int> points;
    for (const int t : body_.triangles)
      points.insert(points.end(), discrete_.mesh.triangles[t].begin(), discrete_.mesh.triangles[t].end());
    std::ranges::sort(points);
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (const int point : points) {
      const double couple = -discrete_.coupling_load[discrete_.traces.rotation_at(point)];
      work.add(couple / frame_.size(), Eigen::RowVector3d::UnitZ());
    }
  }

  RigidFrame frame_;
  const Discretization& discrete_;
  Body body_;
  int components_;
};

/// Collects conditions that a motion must fulfil, functional · motion = 0, and tells which motions do.
class Conditions {
 public:
  void add(const Eigen::RowVector3d& functional) {
    square_ += functional.transpose() * functional;
    ++count_;
  }

  int count() const { return count_; }

  Motions fulfilled_by(const Motions& motions) const {
    if (count_ == 0) return motions;
    const Eigen::MatrixXd reduced = motions.transpose() * square_ * motions / count_;
    const Spectrum spectrum(reduced);
    // The eigenvalues ascend.
    return motions * spectrum.vectors.leftCols((spectrum.values.array() < 1e-12).count());
  }

 private:
  Eigen::Matrix3d square_ = Eigen::Matrix3d::Zero();
  int count_ = 0;
};

Motions left_free(const Discretization& discrete, const RigidBody& body) {
  Conditions conditions;
  body.where_fixed([&](const Point& x) {
    for (int c = 0; c < discrete.spaces().components; ++c) conditions.add(body.frame().component(c, x));
  });
  body.on_rollers(
      [&](const Vector& normal, const Point& x) { conditions.add(body.frame().along(normal, x)); });
  return conditions.fulfilled_by(body.all());
}

/// Of a motion and its reverse, the one whose largest component is positive.
RigidMotion upright(const RigidMotion& motion) {
  Eigen::Index largest;
  motion.cwiseAbs().maxCoeff(&largest);
  return motion[largest] < 0 ? RigidMotion(-motion) : motion;
}

void refuse_sliding(const RigidBody& body, const Motions& free) {
  Conditions conditions;
  body.at_contact([&](const Vector& direction, const Point& x, double) {
    conditions.add(body.frame().along(direction, x));
  });
  const Motions sliding = conditions.fulfilled_by(free);
  if (sliding.cols() == 0) return;
  throw SolveError(
      "nothing holds " + body.name() + " against a " + body.name(upright(sliding.col(0))) +
      ": no fixed part or roller prevents it, and " +
      (conditions.count() > 0 ? "it slides along the contact without friction" : "the body has no contact") +
      "; fix a part, or add a roller that prevents it");
}

/// Means over edges, which are all that a clearance of order 0 has, do not see an edge that turns about its
/// middle: on a disc they let it turn.
void refuse_unseen(const Discretization& discrete, const RigidBody& body, const Motions& free) {
  if (discrete.spaces().order > 0) return;
  Conditions conditions;
  body.in_middles_of_contact(
      [&](const Vector& direction, const Point& x) { conditions.add(body.frame().along(direction, x)); });
  const Motions unseen = conditions.fulfilled_by(free);
  if (unseen.cols() == 0) return;
  throw SolveError(
      "nothing holds " + body.name() + " against a " + body.name(upright(unseen.col(0))) +
      ": no fixed part or roller prevents it, and the nonconforming scheme, which sees a contact "
      "in the middles of its edges, lets it slide along; use the conforming scheme, fix a part, "
      "or add a roller that prevents it");
}

/// What contact and loads say of the free motions of a body, in the coordinates of these.
struct MotionBalance {
  std::vector<Eigen::VectorXd> normals;  ///< r_n at the ends of the edges of Γ_C
  std::vector<double> gaps;              ///< there
  Eigen::VectorXd load;                  ///< (f, r) + <t, r>; 0 if it is rounding
  bool is_loaded;
};

MotionBalance balance_of(const RigidBody& body, const Motions& free) {
  MotionBalance balance;
  body.at_contact([&](const Vector& direction, const Point& x, double gap) {
    balance.normals.push_back((body.frame().along(direction, x) * free).transpose());
    balance.gaps.push_back(gap);
  });
  const RigidBody::Work work = body.work();
  balance.load = (work.sum * free).transpose();
  balance.is_loaded = work.terms.sum() > 0;
  const double rounding = 1e-12 * work.terms.sum();
  if (balance.load.norm() <= rounding) balance.load.setZero();
  return balance;
}

/// A free motion that no contact prevents, r_n ≤ 0, and against which the load does no work, L(r) ≥ 0: one
/// that it works on if there is any; 0 if there is none at all.
///
/// By Fichera (1964) the energy has a minimum over the displacements with u_n ≤ g if L(r) < 0 for every rigid
/// r ≠ 0 with r_n ≤ 0, nothing sliding, and only if L(r) ≤ 0. The polar of these r is the cone of the
/// normals, so that L must lie in its interior: it stays in the cone when it is changed a little in any
/// direction. Where the normals span all motions there is no such r, and the body needs no load to be held.
Eigen::VectorXd unhindered_motion(const MotionBalance& balance) {
  const Eigen::VectorXd& load = balance.load;
  if (Eigen::VectorXd lifted = beyond_cone(balance.normals, load); !lifted.isZero(0)) return lifted;
  const double little = load.isZero(0) ? 1 : 1e-6 * load.norm();
  for (Eigen::Index k = 0; k < load.size(); ++k)
    for (const double change : {little, -little}) {
      Eigen::VectorXd changed = load;
      changed[k] += change;
      if (Eigen::VectorXd motion = beyond_cone(balance.normals, changed); !motion.isZero(0)) return motion;
    }
  return Eigen::VectorXd::Zero(load.size());
}

void refuse_lifting(const RigidBody& body, const Motions& free, const MotionBalance& balance) {
  const Eigen::VectorXd motion = unhindered_motion(balance);
  if (motion.isZero(0)) return;
  const bool works = balance.load.dot(motion) > 1e-6 * balance.load.norm() * motion.norm();
  throw SolveError("nothing holds " + body.name() + " but contact, and contact cannot hold it against a " +
                   body.name(free * motion) + ": the load would have to press the body on its contact, but " +
                   (works ? "it does not (it lifts it off)" : "it does no work at all") + "; fix a part or " +
                   (works ? "reverse the load" : "give a load that presses"));
}

/// Without a load the body moves as far as its contacts let it. It can if a motion has r_n < g everywhere; if
/// not, by Farkas' lemma, there are pressures in balance with Σ p g ≤ 0 and Σ p = 1.
void refuse_floating(const RigidBody& body, const MotionBalance& balance) {
  if (balance.is_loaded) return;
  const Eigen::Index d = balance.load.size();
  double largest = 0;
  for (const double gap : balance.gaps) largest = std::max(largest, std::abs(gap));
  if (largest == 0) return;
  Eigen::VectorXd slack = Eigen::VectorXd::Unit(d + 2, d);
  std::vector<Eigen::VectorXd> pressures{slack};
  for (std::size_t i = 0; i < balance.normals.size(); ++i) {
    pressures.emplace_back(d + 2);
    pressures.back() << balance.normals[i], balance.gaps[i] / largest, 1;
  }
  if (beyond_cone(pressures, Eigen::VectorXd::Unit(d + 2, d + 1)).isZero(0)) return;
  throw SolveError(
      "nothing holds " + body.name() +
      " but contact, and it floats between its contacts: without a load and with gaps all around "
      "nothing tells where it rests; give a load, close the gaps or fix a part");
}

bool held_by_contact_alone(const Discretization& discrete, const RigidBody& body) {
  const Motions free = left_free(discrete, body);
  if (free.cols() == 0) return false;
  refuse_sliding(body, free);
  refuse_unseen(discrete, body, free);
  const MotionBalance balance = balance_of(body, free);
  refuse_lifting(body, free, balance);
  refuse_floating(body, balance);
  return true;
}

}  // namespace

bool held_by_contact_alone(const Discretization& discrete) {
  bool any = false;
  for (Body& body : bodies_of(discrete))
    any = held_by_contact_alone(discrete, RigidBody(discrete, std::move(body))) || any;
  return any;
}

}  // namespace signorini
