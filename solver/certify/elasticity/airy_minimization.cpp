#include "certify/elasticity/airy_minimization.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <unordered_map>

#include "certify/elasticity/johnson_mercier_data.hpp"
#include "certify/elasticity/johnson_mercier_operators.hpp"
#include "certify/pressure/admissible_minimum.hpp"
#include "certify/pressure/layers.hpp"
#include "mesh/parts.hpp"

namespace signorini {
namespace {

using Airy = ContactPressure::Airy;

constexpr int kAiryLayers = 6;
/// Points with less than this part of the largest |∇ψ| + |ψ| / h are left to their surroundings.
constexpr double kHardlyLower = 1e-6;

/// A point with its unknowns: (ψ, ∇ψ), or where the contact has a direction (ψ, b) with ∇ψ = b (d_y, −d_x).
struct AiryPlace {
  int first = -1;
  Eigen::Matrix<double, 3, Eigen::Dynamic> values{3, 0};

  int size() const { return static_cast<int>(values.cols()); }
};

/// A contact edge in the direction in which the domain lies on its left.
struct AirySide {
  int number;  ///< in the clearance space
  int from, to;
  bool forward;                        ///< from is the edge's first point
  bool has_direction;                  ///< other than its normal
  Eigen::Matrix<double, 2, 6> change;  ///< of p* at from and to, by (ψ, ∇ψ) there
};

Airy airy_of(const Eigen::Vector3d& values) {
  return {values[0], values.tail<2>()};
}

class Minimization {
 public:
  Minimization(const Discretization& discrete, const Eigen::MatrixXd& stress, ContactPressure& pressure,
               Progress& progress)
      : discrete_(discrete),
        mesh_(discrete.mesh),
        pressure_(pressure),
        side_of_edge_(mesh_.edges.size(), -1),
        places_(mesh_.points.size()) {
    for (int i = 0; i < static_cast<int>(discrete.clearance.edges.size()); ++i) add_side(i);
    place_unknowns();
    assemble(stress, EdgeTractions(discrete, stress, pressure, progress), progress);
  }

  void run(const AdmissibleDisplacement& v, const Eigen::VectorXd& clearance, Progress& progress) {
    std::vector<MovingPressure> moving;
    for (const AirySide& side : sides_) {
      std::array<LinearForm, 2> changes = changes_of(side);
      if (changes[0].empty()) continue;
      std::ranges::move(moving_pressures(discrete_, v, clearance, pressure_, side.number, std::move(changes)),
                        std::back_inserter(moving));
    }
    const Eigen::VectorXd found =
        admissible_minimum(std::move(curvature_), slope_, moving, without_friction(), progress);
    move(moving, found, pressure_);
    store(found);
  }

 private:
  void store(const Eigen::VectorXd& found) {
    for (std::size_t point = 0; point < places_.size(); ++point) {
      const AiryPlace& place = places_[point];
      if (place.size() == 0) continue;
      const Eigen::Vector3d own = place.values * found.segment(place.first, place.size());
      Airy& airy = pressure_.airy_at_points[static_cast<int>(point)];
      airy.value += own[0];
      airy.gradient += own.tail<2>();
    }
  }

  void add_side(int i) {
    const ContactEdge& contact = discrete_.clearance.edges[i];
    const auto [from, to] = domain_on_the_left(mesh_, contact.edge);
    const Vector way = mesh_.points[to] - mesh_.points[from], d = contact.direction;
    const double length = way.norm(), across = d.dot(Vector(way.y(), -way.x())) / length;
    // b along the edge is quadratic; its mean is −(ψ(to) − ψ(from)) / (|e| d·n).
    Eigen::Matrix<double, 1, 6> mean, at_from, at_to;
    mean << 1, 0, 0, -1, 0, 0;
    mean /= length * across;
    at_from << 0, d.y(), -d.x(), 0, 0, 0;
    at_to << 0, 0, 0, 0, d.y(), -d.x();
    const std::string& part = mesh_.boundary[discrete_.clearance.rows[contact.rows[0]].part].name;
    const bool has_direction = !condition_on<Contact>(discrete_.problem, part)->direction.isZero(0);
    AirySide side{i, from, to, mesh_.edges[contact.edge][0] == from, has_direction, {}};
    side.change << (6 * mean - 4 * at_from - 2 * at_to) / length,
        (-6 * mean + 2 * at_from + 4 * at_to) / length;
    side_of_edge_[contact.edge] = static_cast<int>(sides_.size());
    sides_.push_back(side);
  }

  /// |∇ψ| + |ψ| / h with the shortest contact edge h there: ψ would fall so steeply to 0 beside the point.
  std::unordered_map<int, double> slopes_at_points() const {
    std::unordered_map<int, double> slopes;
    for (const AirySide& side : sides_)
      for (const int point : {side.from, side.to})
        if (const auto found = pressure_.airy_at_points.find(point);
            found != pressure_.airy_at_points.end()) {
          const Airy& airy = found->second;
          const double h = (mesh_.points[side.to] - mesh_.points[side.from]).norm();
          double& slope = slopes[point];
          slope = std::max(slope, airy.gradient.norm() + std::abs(airy.value) / h);
        }
    return slopes;
  }

  void place_unknowns() {
    std::vector<int> points;
    const std::unordered_map<int, double> slopes = slopes_at_points();
    double largest = 0;
    for (const auto& [point, slope] : slopes) largest = std::max(largest, slope);
    for (const auto& [point, slope] : slopes)
      if (slope > kHardlyLower * largest) points.push_back(point);
    const std::vector<int> layers = layers_around(mesh_, points, kAiryLayers);
    std::vector<bool> held(mesh_.points.size(), false);
    for (const BoundaryPart& part : mesh_.boundary) {
      if (condition_on<Fixed>(discrete_.problem, part.name) ||
          condition_on<Contact>(discrete_.problem, part.name))
        continue;
      for (const int edge : part.edges)
        for (const int point : mesh_.edges[edge]) held[point] = true;
    }
    // 0 stands for the normals.
    std::vector<std::optional<Vector>> directions(mesh_.points.size());
    for (const AirySide& side : sides_)
      for (const int point : {side.from, side.to}) {
        const Vector d = side.has_direction ? direction(side) : Vector(0, 0);
        if (!directions[point]) directions[point] = d;
        if ((*directions[point] - d).norm() > 1e-12) held[point] = true;
      }
    int unknowns = 0;
    for (std::size_t point = 0; point < places_.size(); ++point) {
      if (layers[point] >= kAiryLayers || held[point]) continue;
      const Vector d = directions[point].value_or(Vector(0, 0));
      if (d.isZero(0)) {
        places_[point].values = Eigen::Matrix3d::Identity();
      } else {
        places_[point].values.resize(3, 2);
        places_[point].values << 1, 0, 0, d.y(), 0, -d.x();
      }
      places_[point].first = unknowns;
      unknowns += places_[point].size();
    }
    slope_ = Eigen::VectorXd::Zero(unknowns);
  }

  /// The change of a triangle's data by (ψ, ∇ψ) at its corners.
  Eigen::Matrix<double, JohnsonMercier::kData, 9> data_of_airy(int t, const AffineMap& map) const {
    const auto& corners = mesh_.triangles[t];
    Eigen::Matrix<double, JohnsonMercier::kData, 9> data = decltype(data)::Zero();
    for (int e = 0; e < 3; ++e) {
      const int from = (e + 1) % 3, to = (e + 2) % 3, side = side_of_edge_[mesh_.triangle_edges[t][e]];
      const Vector way = mesh_.points[corners[to]] - mesh_.points[corners[from]];
      for (int k = 0; k < 6; ++k) {
        Eigen::Matrix2d ends;
        if (side >= 0 && sides_[side].has_direction) {
          const Vector& d = direction(sides_[side]);
          ends << -sides_[side].change(0, k) * d, -sides_[side].change(1, k) * d;
        } else {
          const Eigen::Vector3d unit = Eigen::Vector3d::Unit(k % 3);
          ends = EdgeTractions::of_airy(k < 3 ? airy_of(unit) : Airy{}, k < 3 ? Airy{} : airy_of(unit), way);
        }
        Eigen::Matrix<double, 2, 3> all;
        all << ends, ends.rowwise().mean();
        data.block<6, 1>(6 * e, 3 * (k < 3 ? from : to) + k % 3) += traction_data(map, e, all);
      }
    }
    return data;
  }

  void assemble(const Eigen::MatrixXd& stress, const EdgeTractions& tractions, Progress& progress) {
    const JohnsonMercierRule& rule = johnson_mercier_rule(discrete_.spaces(), 6);
    LawField<2> law(discrete_.problem.material);
    curvature_.resize(slope_.size(), slope_.size());
    // Entries are added up in parts no larger than what is there: all at once they would be several times
    // that.
    constexpr std::size_t few = 1 << 16;
    std::vector<Eigen::Triplet<double>> entries;
    const auto add_up = [&] {
      Eigen::SparseMatrix<double> part(slope_.size(), slope_.size());
      part.setFromTriplets(entries.begin(), entries.end());
      curvature_ += part;
      entries.clear();
    };
    for (int t = 0; t < discrete_.triangles(); ++t) {
      progress.check_in(t);
      if (entries.size() > std::max(few, static_cast<std::size_t>(curvature_.nonZeros()))) add_up();
      const auto& corners = mesh_.triangles[t];
      if (std::ranges::all_of(corners, [&](int point) { return places_[point].size() == 0; })) continue;
      const AffineMap map(mesh_.corners(t));
      // (ψ, ∇ψ) at three corners, and what is there.
      constexpr int columns = 10;
      Eigen::Matrix<double, JohnsonMercier::kData, Eigen::Dynamic> data(JohnsonMercier::kData, columns);
      data << data_of_airy(t, map), johnson_mercier_data(discrete_, tractions, t, map);
      Eigen::MatrixXd coefficients(stress.rows(), columns);
      coefficients << Eigen::MatrixXd::Zero(stress.rows(), 9), stress.col(t);
      const std::vector<SymmetricLaw> laws = laws_at(discrete_, rule, map, law);
      JohnsonMercierStress<Eigen::Dynamic> sigma(map, data, coefficients);
      const Eigen::MatrixXd corrections =
          correction<Eigen::Dynamic>(rule, map, minimized(sigma, rule, laws), laws);
      const auto changes = corrections.leftCols<9>();
      const Eigen::Matrix<double, 9, 9> own = 2 * changes.transpose() * changes;
      const Eigen::Matrix<double, 9, 1> towards = 2 * changes.transpose() * corrections.col(9);
      for (int k = 0; k < 3; ++k) {
        const AiryPlace& row = places_[corners[k]];
        if (row.size() == 0) continue;
        slope_.segment(row.first, row.size()) += row.values.transpose() * towards.segment<3>(3 * k);
        for (int l = 0; l < 3; ++l) {
          const AiryPlace& column = places_[corners[l]];
          if (column.size() == 0) continue;
          const Eigen::MatrixXd block =
              row.values.transpose() * own.block<3, 3>(3 * k, 3 * l) * column.values;
          for (int a = 0; a < row.size(); ++a)
            for (int b = 0; b < column.size(); ++b)
              entries.emplace_back(row.first + a, column.first + b, block(a, b));
        }
      }
    }
    add_up();
  }

  const Vector& direction(const AirySide& side) const {
    return discrete_.clearance.edges[side.number].direction;
  }

  /// The traction has no tangential part where ∂_n ψ is the same at both ends of a side. Along a direction
  /// that the unknowns have it is so.
  std::vector<LinearForm> without_friction() const {
    std::vector<LinearForm> conditions;
    for (const AirySide& side : sides_) {
      if (side.has_direction) continue;
      LinearForm condition;
      for (const auto& [point, sign] : {std::pair(side.from, -1), {side.to, 1}}) {
        const AiryPlace& place = places_[point];
        if (place.size() == 0) continue;
        const Eigen::RowVectorXd row = sign * direction(side).transpose() * place.values.bottomRows<2>();
        for (int a = 0; a < place.size(); ++a) condition.emplace_back(place.first + a, row[a]);
      }
      if (!condition.empty()) conditions.push_back(condition);
    }
    return conditions;
  }

  /// Of p* at the edge's first and second point, by the unknowns.
  std::array<LinearForm, 2> changes_of(const AirySide& side) const {
    std::array<LinearForm, 2> changes;
    for (int end = 0; end < 2; ++end)
      for (int k = 0; k < 2; ++k) {
        const AiryPlace& place = places_[k == 0 ? side.from : side.to];
        const Eigen::RowVectorXd row = side.change.block<1, 3>(end, 3 * k) * place.values;
        for (int a = 0; a < place.size(); ++a)
          changes[side.forward ? end : 1 - end].emplace_back(place.first + a, row[a]);
      }
    return changes;
  }

  const Discretization& discrete_;
  const Mesh& mesh_;
  ContactPressure& pressure_;
  std::vector<int> side_of_edge_;  ///< of each edge of the mesh, or -1
  std::vector<AiryPlace> places_;  ///< of each point
  std::vector<AirySide> sides_;
  Eigen::SparseMatrix<double> curvature_;
  Eigen::VectorXd slope_;
};

}  // namespace

void minimize_airy(const Discretization& discrete, const Eigen::MatrixXd& stress,
                   const AdmissibleDisplacement& v, const Eigen::VectorXd& clearance,
                   ContactPressure& pressure, Progress& progress) {
  if (pressure.airy_at_points.empty()) return;
  Minimization(discrete, stress, pressure, progress).run(v, clearance, progress);
}

}  // namespace signorini
