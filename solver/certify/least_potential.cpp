#include "certify/least_potential.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

#include "certify/potential_nodes.hpp"
#include "mesh/parts.hpp"

namespace signorini {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

constexpr int kSteps = 20;
/// Ends that would stop a step within this part of it are kept together.
constexpr double kTogether = 1e-3;

/// A contact edge from its first to its second point.
struct Side {
  int number;                ///< in the clearance space
  std::array<int, 3> nodes;  ///< first, second, middle
  double scale;              ///< 1 / length, negative if the domain lies on the right
  std::array<bool, 2> kept;  ///< p* stays what it is at this end

  /// What p* changes by at an end if Ψ changes by d at the nodes.
  double change(int end, const Eigen::Vector3d& d) const {
    return scale * (end == 0 ? -3 * d[0] - d[1] + 4 * d[2] : d[0] + 3 * d[1] - 4 * d[2]);
  }
  /// The same if the middle is to keep p* there: its change as a combination of the two points.
  Eigen::Vector2d middle_for(int end) const {
    return end == 0 ? Eigen::Vector2d(0.75, 0.25) : Eigen::Vector2d(0.25, 0.75);
  }
};

class Minimization {
 public:
  Minimization(const Discretization& problem, const AdmissibleDisplacement& v,
               const Eigen::VectorXd& clearance, ContactPressure& pressure, const StressField& d)
      : problem_(problem),
        v_(v),
        pressure_(pressure),
        nodes_(d ? PotentialNodes(problem) : PotentialNodes(problem, pressure)),
        potential_(Eigen::VectorXd::Zero(nodes_.size())),
        slope_(Eigen::VectorXd::Zero(nodes_.size())) {
    for (const auto& [point, value] : pressure.potential_at_points)
      if (nodes_.at_point(point) >= 0) potential_[nodes_.at_point(point)] = value;
    for (const auto& [edge, value] : pressure.potential_at_middles)
      if (nodes_.at_middle(edge) >= 0) potential_[nodes_.at_middle(edge)] = value;
    for (int i = 0; i < static_cast<int>(problem.clearance.edges.size()); ++i) add_side(i, clearance);
    assemble(d);
  }

  /// Goes towards the minimum as far as p* ≥ 0 allows. Returns false once it is there.
  bool step() {
    const Sparse basis = free_changes();
    if (basis.cols() == 0) return false;
    Sparse matrix = basis.transpose() * curvature_ * basis;
    // A constant Ψ is no stress: where nothing else fixes it, this does.
    matrix.diagonal() *= 1 + 1e-10;
    const Eigen::SimplicialLDLT<Sparse> factor(matrix);
    if (factor.info() != Eigen::Success) return false;
    const Eigen::VectorXd descent = -(basis.transpose() * (curvature_ * potential_ + slope_));
    const Eigen::VectorXd change = basis * factor.solve(descent).eval();
    const double way = allowed(change);
    potential_ += way * change;
    for (Side& side : sides_)
      for (int end = 0; end < 2; ++end) {
        if (side.kept[end]) continue;
        const double own = side.change(end, at(side, change));
        side.kept[end] = way < 1 && pressure(side, end) + (way + kTogether) * own <= 0;
        move(side, end, way * own);
      }
    return way < 1;
  }

  void store() {
    const Mesh& mesh = problem_.mesh;
    for (const int t : nodes_.triangles())
      for (int k = 0; k < 3; ++k) {
        const int point = mesh.triangles[t][k], edge = mesh.triangle_edges[t][k];
        if (nodes_.at_point(point) >= 0)
          pressure_.potential_at_points[point] = potential_[nodes_.at_point(point)];
        if (nodes_.at_middle(edge) >= 0)
          pressure_.potential_at_middles[edge] = potential_[nodes_.at_middle(edge)];
      }
  }

 private:
  void assemble(const StressField& d) {
    LawField<1> law(problem_.problem.material);
    std::vector<Eigen::Triplet<double>> entries;
    for (const int t : nodes_.triangles()) {
      const AffineMap map(problem_.mesh.corners(t));
      const std::array<int, 6> nodes = nodes_.on(t);
      Eigen::Matrix<double, 6, 6> own = Eigen::Matrix<double, 6, 6>::Zero();
      Eigen::Matrix<double, 6, 1> towards = Eigen::Matrix<double, 6, 1>::Zero();
      for (int q = 0; q < TriangleRule::size; ++q) {
        const Point& reference = triangle_rule().points[q];
        const Eigen::Matrix<double, 2, 6> rises =
            map.jacobian.inverse().transpose() * quadratic_gradients(reference);
        Eigen::Matrix<double, 2, 6> curls;
        curls << rises.row(1), -rises.row(0);
        const Eigen::Matrix<double, 6, 2> strains = 2 * triangle_rule().weights[q] * map.determinant *
                                                    curls.transpose() * law(map(reference)).compliance;
        own += strains * curls;
        if (d) towards += strains * d(t, reference);
      }
      for (int a = 0; a < 6; ++a) {
        if (nodes[a] < 0) continue;
        slope_[nodes[a]] -= towards[a];
        for (int b = 0; b < 6; ++b)
          if (nodes[b] >= 0) entries.emplace_back(nodes[a], nodes[b], own(a, b));
      }
    }
    curvature_.resize(nodes_.size(), nodes_.size());
    curvature_.setFromTriplets(entries.begin(), entries.end());
  }

  void add_side(int i, const Eigen::VectorXd& clearance) {
    const ContactEdge& contact = problem_.clearance.edges[i];
    const auto& [a, b] = problem_.mesh.edges[contact.edge];
    const Side side{i,
                    {nodes_.at_point(a), nodes_.at_point(b), nodes_.at_middle(contact.edge)},
                    (domain_on_the_left(problem_.mesh, contact.edge)[0] == a ? 1 : -1) /
                        problem_.mesh.length(contact.edge),
                    {}};
    if (std::ranges::all_of(side.nodes, [](int node) { return node < 0; })) return;
    sides_.push_back(side);
    const bool open = clearance[contact.rows[0]] > 0 && clearance[contact.rows[1]] > 0;
    sides_.back().kept = {open, open};
    for (int q = 0; q < EdgeRule::size; ++q) {
      const double s = edge_rule().points[q];
      const double room =
          edge_rule().weights[q] * problem_.mesh.length(contact.edge) * std::max(0., v_.room(contact, s));
      for (int k = 0; k < 3; ++k)
        if (side.nodes[k] >= 0) {
          const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k);
          slope_[side.nodes[k]] += room * ((1 - s) * side.change(0, unit) + s * side.change(1, unit));
        }
    }
  }

  Eigen::Vector3d at(const Side& side, const Eigen::VectorXd& values) const {
    Eigen::Vector3d own;
    for (int k = 0; k < 3; ++k) own[k] = side.nodes[k] < 0 ? 0 : values[side.nodes[k]];
    return own;
  }

  double& pressure(const Side& side, int end) { return pressure_.at_ends[side.number][end]; }

  void move(const Side& side, int end, double change) {
    pressure(side, end) = std::max(0., pressure(side, end) + change);
    pressure_.changes[side.number][end] += change;
  }

  /// The part of the way on which p* ≥ 0.
  double allowed(const Eigen::VectorXd& change) {
    double way = 1;
    for (const Side& side : sides_)
      for (int end = 0; end < 2; ++end) {
        const double own = side.change(end, at(side, change)), rest = pressure(side, end);
        if (!side.kept[end] && rest + way * own < 0) way = rest / -own;
      }
    return way;
  }

  /// By columns, the changes of Ψ that change no pressure that is kept: Ψ rises by nothing along an edge that
  /// keeps both ends; one that keeps one end gives up its middle.
  Sparse free_changes() const {
    std::vector<int> group(nodes_.size() + 1);
    std::iota(group.begin(), group.end(), 0);
    const auto root = [&](int node) {
      // The last group is that of Ψ = 0.
      int of = node < 0 ? nodes_.size() : node;
      while (group[of] != of) of = group[of] = group[group[of]];
      return of;
    };
    const auto join = [&](int a, int b) {
      const std::pair<int, int> ends = std::minmax({root(a), root(b)});
      group[ends.first] = ends.second;
    };
    for (const Side& side : sides_)
      if (side.kept[0] && side.kept[1]) {
        join(side.nodes[0], side.nodes[1]);
        join(side.nodes[0], side.nodes[2]);
      }
    std::vector<bool> gives_up(nodes_.size(), false);
    for (const Side& side : sides_)
      if (side.kept[0] != side.kept[1]) gives_up[side.nodes[2]] = true;
    std::vector<int> column(nodes_.size() + 1, -1);
    int columns = 0;
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int node, double factor) {
      const int of = root(node);
      if (of == nodes_.size()) return;
      if (column[of] < 0) column[of] = columns++;
      entries.emplace_back(row, column[of], factor);
    };
    for (int node = 0; node < nodes_.size(); ++node)
      if (!gives_up[node]) add(node, node, 1);
    for (const Side& side : sides_)
      if (side.kept[0] != side.kept[1]) {
        const Eigen::Vector2d factors = side.middle_for(side.kept[0] ? 0 : 1);
        for (int k = 0; k < 2; ++k) add(side.nodes[2], side.nodes[k], factors[k]);
      }
    Sparse basis(nodes_.size(), columns);
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
  }

  const Discretization& problem_;
  const AdmissibleDisplacement& v_;
  ContactPressure& pressure_;
  const PotentialNodes nodes_;
  std::vector<Side> sides_;
  Eigen::VectorXd potential_, slope_;  ///< Ψ, and the derivative at Ψ = 0 of what is minimised
  Sparse curvature_;                   ///< its second derivative
};

}  // namespace

void minimize_potential(const Discretization& problem, const AdmissibleDisplacement& v,
                        const Eigen::VectorXd& clearance, ContactPressure& pressure, Progress& progress,
                        const StressField& d) {
  if (!d && pressure.potential_at_points.empty()) return;
  Minimization minimization(problem, v, clearance, pressure, d);
  for (int i = 0; i < kSteps && minimization.step(); ++i) progress.check();
  minimization.store();
}

}  // namespace signorini
