#include "contact/rigid_motions.hpp"

#include <cmath>
#include <sstream>

#include <Eigen/Eigenvalues>

#include "contact/cone.hpp"
#include "mesh/bodies.hpp"
#include "observer.hpp"

namespace signorini {
namespace {

using Motions = Eigen::Matrix<double, 3, Eigen::Dynamic>;  ///< a motion a column

/// One body of the mesh: the displacements of its rigid motions at points, as rows of linear functionals of the
/// motion.
class RigidBody {
 public:
  RigidBody(const Discretization& problem, std::vector<int> triangles)
      : problem_(problem),
        triangles_(std::move(triangles)),
        is_own_(problem.mesh.triangles.size(), false),
        components_(problem.spaces().components),
        size_(std::sqrt(problem.mesh.area())) {
    centre_.setZero();
    for (const int t : triangles_) {
      is_own_[t] = true;
      centre_ += centroid(t) / static_cast<double>(triangles_.size());
    }
  }

  bool is_own(int boundary_edge) const { return is_own_[problem_.mesh.edge_triangles[boundary_edge][0]]; }

  /// Names the body where there are others.
  std::string name() const {
    if (triangles_.size() == problem_.mesh.triangles.size()) return "the body";
    return "the body around " + pair(centre_);
  }

  /// u_c at x.
  Eigen::RowVector3d component(int c, const Point& x) const {
    if (components_ == 1) return {1, 0, 0};
    const Vector arm = (x - centre_) / size_;
    return c == 0 ? Eigen::RowVector3d(1, 0, -arm.y()) : Eigen::RowVector3d(0, 1, arm.x());
  }

  /// u_n at x, with u_n = −u for the membrane.
  Eigen::RowVector3d along(const Vector& normal, const Point& x) const {
    if (components_ == 1) return {-1, 0, 0};
    return normal.x() * component(0, x) + normal.y() * component(1, x);
  }

  Motions all() const {
    return components_ == 1 ? Motions(Eigen::Vector3d::UnitX()) : Motions(Eigen::Matrix3d::Identity());
  }

  std::string name(const RigidMotion& motion) const {
    if (components_ == 1) return "translation";
    const double rotation = motion[2] / size_;
    if (std::abs(motion[2]) < 1e-6 * motion.norm()) {
      const Vector direction =
          motion.head<2>().normalized().unaryExpr([](double c) { return std::abs(c) < 1e-9 ? 0 : c; });
      return "translation along " + pair(direction);
    }
    return "rotation about " + pair(centre_ + Vector(-motion.y(), motion.x()) / rotation);
  }

  /// Calls visit(normal, point) at both ends of each own edge of a part.
  template <typename Visit>
  void at_ends(const BoundaryPart& part, const Visit& visit) const {
    for (const int edge : part.edges)
      if (is_own(edge)) at_ends(edge, problem_.mesh.outward_normal(edge), visit);
  }

  /// Calls visit(direction, point) at both ends of each own edge of Γ_C.
  template <typename Visit>
  void at_contact(const Visit& visit) const {
    for (const ContactEdge& contact : problem_.clearance.edges)
      if (is_own(contact.edge)) at_ends(contact.edge, contact.direction, visit);
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
    const Mesh& mesh = problem_.mesh;
    for (const int t : triangles_) {
      const LocalVector load = problem_.load.col(t);
      const auto corners = mesh.corners(t);
      for (int i = 0; i < load.size(); ++i) {
        const Point x = problem_.spaces().order == 0 ? centroid(t) : corners[i / components_];
        work.add(load[i], component(i % components_, x));
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

  Point centroid(int t) const {
    const auto corners = problem_.mesh.corners(t);
    return (corners[0] + corners[1] + corners[2]) / 3;
  }

  template <typename Visit>
  void at_ends(int edge, const Vector& direction, const Visit& visit) const {
    for (const int point : problem_.mesh.edges[edge]) visit(direction, problem_.mesh.points[point]);
  }

  void add_traction(int t, Work& work) const {
    const auto corners = problem_.mesh.corners(t);
    const int per_edge = problem_.spaces().traces_per_edge();
    for (int j = 0; j < 3 * per_edge; ++j) {
      const int dof = problem_.traces.dof(t, j), e = j / per_edge, function = j % per_edge / components_;
      if (!problem_.traces.is_free(dof)) continue;
      const double force = problem_.coupling_load[problem_.traces[dof].unknown];
      if (force == 0) continue;
      const Point a = corners[(e + 1) % 3], b = corners[(e + 2) % 3];
      const Point x = problem_.spaces().order == 0 ? Point((a + b) / 2) : (function == 0 ? a : b);
      work.add(force, component(j % components_, x));
    }
  }

  /// The third motion turns by 1 / size, and γ is minus the rotation.
  void add_couples(Work& work) const {
    if (!problem_.spaces().leaves_couples()) return;
    std::vector<bool> seen(problem_.mesh.points.size(), false);
    for (const int t : triangles_)
      for (const int point : problem_.mesh.triangles[t]) {
        if (seen[point]) continue;
        seen[point] = true;
        const double couple = -problem_.coupling_load[problem_.traces.rotation_at(point)];
        work.add(couple / size_, Eigen::RowVector3d::UnitZ());
      }
  }

  const Discretization& problem_;
  std::vector<int> triangles_;
  std::vector<bool> is_own_;  ///< of each triangle of the mesh
  int components_;
  double size_;
  Point centre_;
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
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(reduced);
    std::vector<int> null;
    for (int i = 0; i < eigen.eigenvalues().size(); ++i)
      if (eigen.eigenvalues()[i] < 1e-12) null.push_back(i);
    return motions * eigen.eigenvectors()(Eigen::all, null);
  }

 private:
  Eigen::Matrix3d square_ = Eigen::Matrix3d::Zero();
  int count_ = 0;
};

Motions left_free(const Discretization& problem, const RigidBody& body) {
  Conditions conditions;
  for (const BoundaryPart& part : problem.mesh.boundary) {
    if (condition_on<Fixed>(problem.problem, part.name))
      body.at_ends(part, [&](const Vector&, const Point& x) {
        for (int c = 0; c < problem.spaces().components; ++c) conditions.add(body.component(c, x));
      });
    if (condition_on<Roller>(problem.problem, part.name))
      body.at_ends(part,
                   [&](const Vector& normal, const Point& x) { conditions.add(body.along(normal, x)); });
  }
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
  body.at_contact([&](const Vector& direction, const Point& x) { conditions.add(body.along(direction, x)); });
  const Motions sliding = conditions.fulfilled_by(free);
  if (sliding.cols() == 0) return;
  throw SolveError("nothing holds " + body.name() + " against a " + body.name(upright(sliding.col(0))) +
                   ": no fixed part or roller prevents it, and " +
                   (conditions.count() > 0 ? "it slides along the contact without friction"
                                           : "the body has no contact") +
                   "; fix a part, or add a roller that prevents it");
}

/// At rest the pressures p ≥ 0 balance the load in every free motion z: Σ p z_n = (f, z) + <t, z>.
void refuse_lifting(const RigidBody& body, const Motions& free) {
  std::vector<Eigen::VectorXd> normals;
  body.at_contact([&](const Vector& direction, const Point& x) {
    normals.push_back((body.along(direction, x) * free).transpose());
  });
  const RigidBody::Work work = body.work();
  const Eigen::VectorXd load = (work.sum * free).transpose();
  const double rounding = 1e-12 * work.terms.sum();
  if (load.norm() > rounding && is_inside_cone(normals, load)) return;
  const RigidMotion lifting = load[0] < 0 ? RigidMotion(-free.col(0)) : RigidMotion(free.col(0));
  const std::string found =
      load.norm() > rounding ? "it does not (it lifts it off)" : "it does no work at all";
  throw SolveError("nothing holds " + body.name() + " but contact, and contact cannot hold it against a " +
                   body.name(lifting) + ": the load would have to press the body on its contact, but " +
                   found + "; fix a part or reverse the load");
}

bool held_by_contact_alone(const Discretization& problem, const RigidBody& body) {
  const Motions free = left_free(problem, body);
  if (free.cols() == 0) return false;
  refuse_sliding(body, free);
  refuse_lifting(body, free);
  return true;
}

}  // namespace

bool held_by_contact_alone(const Discretization& problem) {
  bool any = false;
  for (std::vector<int>& triangles : bodies(problem.mesh))
    any = held_by_contact_alone(problem, RigidBody(problem, std::move(triangles))) || any;
  return any;
}

}  // namespace signorini
