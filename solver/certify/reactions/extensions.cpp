#include "certify/reactions/extensions.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "certify/tensor.hpp"
#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "fem/per_shape.hpp"
#include "system/factorize.hpp"

namespace signorini {
namespace {

/// Values that rounding may have moved by this much, relative, are the same.
constexpr double kRoundingOfValues = 1e-12;
/// Where directions are so nearly the same that what meets both is so many times as large as what was to be
/// met, it is not worth having.
constexpr double kMost = 1e3;
/// So much of the diagonal stands in the way of motions that nothing holds, and bends others by no more.
constexpr double kLoose = 1e-11;

double cross(const Vector& one, const Vector& other) {
  return one.x() * other.y() - one.y() * other.x();
}

bool has(const std::vector<int>& parts, int part) {
  return std::ranges::find(parts, part) != parts.end();
}

/// The strain, a tensor row by row, of displacements at the corners, corner by corner.
template <int D>
Eigen::Matrix<double, 2 * D, 3 * D> strains(const AffineMap& map) {
  const Eigen::Matrix<double, 2, 3> gradients = hat_gradients(map);
  Eigen::Matrix<double, 2 * D, 3 * D> all = Eigen::Matrix<double, 2 * D, 3 * D>::Zero();
  for (int z = 0; z < 3; ++z)
    for (int c = 0; c < D; ++c)
      for (int d = 0; d < 2; ++d) {
        all(2 * c + d, D * z + c) += gradients(d, z) / (D == 1 ? 1 : 2);
        if (D == 2) all(2 * d + c, D * z + c) += gradients(d, z) / 2;
      }
  return all;
}

/// The mean of E over a triangle, or more, times its area.
template <int D>
TensorMap<D> stiffness_from_above(int t, const AffineMap& map, LawField<D>& law, const LawOnMesh& laws) {
  const TrianglePiece whole{{Point(0, 0), Point(1, 0), Point(0, 1)}, 1, {}};
  const std::vector<LawPiece> cut = laws.cut(t);
  TensorMap<D> sum = TensorMap<D>::Zero();
  const auto add = [&](const LawPiece& piece, const TrianglePiece& place) {
    const int degree = piece.degree_of_rule(0, laws.tolerance());
    const double error = piece.error_of_rule(degree, 0);
    const bool is_known = error < 0.5;
    for (const auto& [point, weight] : rule_of_degree(degree)) {
      const double share = weight * place.share * map.determinant;
      if (is_known)
        sum += share * (1 + error) / (1 - error) * law(map(place(point))).stiffness;
      else
        sum.diagonal().array() += share * piece.stiffest;
    }
  };
  if (cut.empty()) add(laws.whole(t), whole);
  for (const LawPiece& piece : cut) add(piece, piece.place);
  return sum;
}

}  // namespace

double Extensions::Hat::operator()(const Point& x) const {
  const Vector way = end - begin;
  // Most points are far away, which is seen without a root.
  const double far = way.cwiseAbs().sum() / 2 + reach;
  if ((x - (begin + end) / 2).squaredNorm() > far * far) return 0;
  const double s = std::clamp((x - begin).dot(way) / way.squaredNorm(), 0., 1.);
  return std::max(0., 1 - (begin + s * way - x).norm() / reach);
}

Extensions::Extensions(const Discretization& discrete, const LawOnMesh& laws, Factorization by,
                       Progress& progress, std::shared_ptr<const ElementTree> tree)
    : discrete_(discrete), triangles_(discrete.mesh) {
  stiffness_.tree = std::move(tree);
  hold_parts();
  if (components() == 1)
    add_elements<1>(laws, progress);
  else
    add_elements<2>(laws, progress);
  if (stiffness_.size == 0) return;
  if (!stiffness_.tree)
    stiffness_.tree = tree_by_edges(stiffness_.centres, discrete.mesh.triangle_edges, progress);
  factor_.emplace(factorize(stiffness_, 0, by, progress));
}

void Extensions::hold_parts() {
  const Problem& problem = discrete_.problem;
  const Mesh& mesh = discrete_.mesh;
  for (int part = 0; part < static_cast<int>(mesh.boundary.size()); ++part) {
    const std::string& name = mesh.boundary[part].name;
    const bool is_fixed = condition_on<Fixed>(problem, name), rolls = condition_on<Roller>(problem, name);
    const Contact* contact = condition_on<Contact>(problem, name);
    if (!is_fixed && !rolls && !contact) continue;
    supports_.push_back(part);
    for (const int edge : mesh.boundary[part].edges)
      for (const int point : mesh.edges[edge]) {
        std::vector<Hold>& holds = holds_[point];
        const Vector normal = mesh.outward_normal(edge);
        if (components() == 1 || is_fixed) holds.push_back({part, Vector::UnitX(), 0});
        if (components() == 2 && is_fixed) holds.push_back({part, Vector::UnitY(), 0});
        if (components() == 2 && !is_fixed)
          holds.push_back(
              {part, contact ? contact->unit_direction(normal) : normal, mesh.rounding_of_normal(edge)});
      }
  }
  if (components() == 1) return;
  for (const auto& [point, holds] : holds_)
    if (const Vector d = holds.front().direction; !other_direction(holds))
      turns_[point] << d.x(), -d.y(), d.y(), d.x();
}

/// The hold whose direction differs most from that of the first, or null if all are the same but for
/// rounding.
const Extensions::Hold* Extensions::other_direction(const std::vector<Hold>& holds) {
  const Hold& first = holds.front();
  const auto turn = [&](const Hold& hold) { return std::abs(cross(first.direction, hold.direction)); };
  const auto other = std::ranges::max_element(holds, {}, turn);
  return turn(*other) > first.rounding + other->rounding ? &*other : nullptr;
}

/// Where points are held along one direction, their rows are those along and across it.
Eigen::MatrixXd Extensions::turned(int t, Eigen::MatrixXd element) const {
  for (int z = 0; z < 3; ++z)
    if (const auto turn = turns_.find(discrete_.mesh.triangles[t][z]); turn != turns_.end()) {
      element.middleCols<2>(2 * z) = (element.middleCols<2>(2 * z) * turn->second).eval();
      element.middleRows<2>(2 * z) = (turn->second.transpose() * element.middleRows<2>(2 * z)).eval();
    }
  return element;
}

template <int D>
void Extensions::add_elements(const LawOnMesh& laws, Progress& progress) {
  const Mesh& mesh = discrete_.mesh;
  // Of a point that is held along one direction the second unknown is free, of any other that is held none.
  std::vector<bool> is_turned(mesh.points.size(), false);
  unknowns_.assign(mesh.points.size() * D, 0);
  for (const auto& [point, holds] : holds_) {
    is_turned[point] = turns_.contains(point);
    for (int c = 0; c < D; ++c) unknowns_[point * D + c] = c == 1 && is_turned[point] ? 0 : -1;
  }
  for (int& unknown : unknowns_)
    if (unknown == 0) unknown = stiffness_.size++;
  stiffness_.per_element = 3 * D;
  const auto triangles = static_cast<std::size_t>(discrete_.triangles());
  stiffness_.unknowns.reserve(3 * D * triangles);
  stiffness_.matrix_of.reserve(triangles);
  stiffness_.centres.reserve(triangles);
  LawField<D> law(discrete_.problem.material);
  struct OfShape {
    int plain = -1;
    std::vector<int> turned = {};
  };
  PerShape<OfShape> shapes(discrete_);
  const auto matrix_of = [&](int t, bool turns) {
    const AffineMap map(mesh.corners(t));
    const Eigen::Matrix<double, 2 * D, 3 * D> strain = strains<D>(map);
    Eigen::MatrixXd matrix = strain.transpose() * stiffness_from_above<D>(t, map, law, laws) * strain;
    if (turns) matrix = turned(t, std::move(matrix));
    matrix.diagonal() *= 1 + kLoose;
    return matrix;
  };
  for (int t = 0; t < discrete_.triangles(); ++t) {
    progress.check_in(t);
    const bool turns = std::ranges::any_of(mesh.triangles[t], [&](int point) { return is_turned[point]; });
    is_turned_.push_back(turns);
    OfShape& numbers = shapes(t, [] { return OfShape(); });
    if (turns) {
      stiffness_.matrix_of.push_back(stiffness_.keep(matrix_of(t, true).data(), numbers.turned));
    } else {
      if (numbers.plain < 0) numbers.plain = stiffness_.keep(matrix_of(t, false).data());
      stiffness_.matrix_of.push_back(numbers.plain);
    }
    stiffness_.centres.push_back(mesh.centroid(t));
    for (const int point : mesh.triangles[t])
      for (int c = 0; c < D; ++c) stiffness_.unknowns.push_back(unknowns_[point * D + c]);
  }
}

/// The value that all holds of a point let it have; nothing if they contradict each other.
std::optional<Vector> Extensions::met(int point, const std::vector<int>& moved, const Given& given) const {
  const std::vector<Hold>& holds = holds_.at(point);
  const double largest =
      std::max(std::abs(given(point, Vector::UnitX())), std::abs(given(point, Vector::UnitY())));
  std::vector<double> values;
  for (const Hold& hold : holds) values.push_back(has(moved, hold.part) ? given(point, hold.direction) : 0);
  const Vector d = holds.front().direction;
  Vector value = values.front() * d;
  if (const Hold* other = other_direction(holds)) {
    Eigen::Matrix2d both;
    both << d.transpose(), other->direction.transpose();
    value = both.fullPivLu().solve(Vector(values.front(), values[other - holds.data()]));
  }
  if (value.norm() > kMost * largest) return std::nullopt;
  for (std::size_t i = 0; i < holds.size(); ++i) {
    const double off = std::abs(value.dot(holds[i].direction) - values[i]);
    if (off > (kRoundingOfValues + holds.front().rounding + holds[i].rounding) * largest) return std::nullopt;
  }
  return value;
}

/// What is held, in the directions of the unknowns, and 0 elsewhere. Adds where it clashes.
Eigen::MatrixXd Extensions::held(const std::vector<int>& moved, const Given& given,
                                 std::vector<Extension::Clash>& clashes) const {
  Eigen::MatrixXd w =
      Eigen::MatrixXd::Zero(components(), static_cast<Eigen::Index>(discrete_.mesh.points.size()));
  for (const auto& [point, holds] : holds_) {
    const auto moves = [&](const Hold& hold) { return has(moved, hold.part); };
    const auto mover = std::ranges::find_if(holds, moves);
    if (mover == holds.end()) continue;
    if (const std::optional<Vector> value = met(point, moved, given)) {
      const auto turn = turns_.find(point);
      w.col(point) =
          (turn == turns_.end() ? *value : Vector(turn->second.transpose() * *value)).head(components());
    } else {
      const auto other = std::ranges::find_if_not(holds, moves);
      clashes.push_back({mover->part, other == holds.end() ? mover->part : other->part, point});
    }
  }
  return w;
}

/// The values at the corners of a triangle, corner by corner.
template <int D>
Eigen::Matrix<double, 3 * D, 1> Extensions::local(int t, const Eigen::MatrixXd& at_points) const {
  Eigen::Matrix<double, 3 * D, 1> all;
  for (int z = 0; z < 3; ++z) {
    const double* own = at_points.data() + D * static_cast<std::size_t>(discrete_.mesh.triangles[t][z]);
    for (int c = 0; c < D; ++c) all[D * z + c] = own[c];
  }
  return all;
}

/// Finds what is free.
template <int D>
void Extensions::complete(Eigen::MatrixXd& w, Progress& progress) const {
  if (!factor_) return;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(stiffness_.size);
  for (int t = 0; t < discrete_.triangles(); ++t) {
    progress.check_in(t);
    const auto own = local<D>(t, w);
    if (own.isZero(0)) continue;
    const Eigen::Map<const Eigen::Matrix<double, 3 * D, 3 * D>> matrix(stiffness_.matrix(t));
    const Eigen::Matrix<double, 3 * D, 1> forces = matrix * own;
    for (int i = 0; i < 3 * D; ++i)
      if (const int unknown = stiffness_.unknowns_of(t)[i]; unknown >= 0) x[unknown] -= forces[i];
  }
  Factor::Workspace workspace;
  factor_->solve(x, workspace, progress);
  for (std::size_t i = 0; i < unknowns_.size(); ++i)
    if (unknowns_[i] >= 0) w.data()[i] = x[unknowns_[i]];
}

/// Of a triangle that is not turned, from what its corners move by beside the first: of a motion of the whole
/// nothing is left.
template <int D>
double Extensions::energy_square(int t, const Eigen::MatrixXd& w) const {
  auto own = local<D>(t, w);
  if (own.isZero(0)) return 0;
  if (!is_turned_[t])
    for (int z = 2; z >= 0; --z) own.template segment<D>(D * z) -= own.template head<D>();
  const Eigen::Map<const Eigen::Matrix<double, 3 * D, 3 * D>> matrix(stiffness_.matrix(t));
  return own.dot(matrix * own);
}

double Extensions::energy_square(int t, const Eigen::MatrixXd& w) const {
  return components() == 1 ? energy_square<1>(t, w) : energy_square<2>(t, w);
}

/// From values in the directions of the unknowns.
void Extensions::turn_back(Eigen::MatrixXd& w) const {
  for (const auto& [point, turn] : turns_) w.col(point) = (turn * w.col(point)).eval();
}

std::vector<Extension::Clash> Extensions::clashes(const std::vector<int>& moved, const Given& given) const {
  std::vector<Extension::Clash> found;
  held(moved, given, found);
  return found;
}

Extension Extensions::operator()(const std::vector<int>& moved, const Given& given,
                                 Progress& progress) const {
  Extension own;
  own.at_points = held(moved, given, own.clashes);
  if (components() == 1)
    complete<1>(own.at_points, progress);
  else
    complete<2>(own.at_points, progress);
  for (int t = 0; t < discrete_.triangles(); ++t) {
    progress.check_in(t);
    own.energy_square += energy_square(t, own.at_points);
  }
  turn_back(own.at_points);
  return own;
}

Extension Extensions::tent(int part, const Given& given, const Hat& hat) const {
  const Mesh& mesh = discrete_.mesh;
  Extension own;
  own.at_points = held({part}, given, own.clashes);
  std::vector<int> raised;
  for (const auto& [point, holds] : holds_)
    if (!own.at_points.col(point).isZero(0)) raised.push_back(point);
  std::vector<bool> is_under(mesh.triangles.size());
  std::vector<int> under;
  for (std::size_t i = 0; i < raised.size(); ++i)
    for (const int t : triangles_[raised[i]]) {
      if (is_under[t]) continue;
      is_under[t] = true;
      under.push_back(t);
      for (const int point : mesh.triangles[t]) {
        if (holds_.contains(point) || !own.at_points.col(point).isZero(0)) continue;
        const double height = hat(mesh.points[point]);
        if (!(height > 0)) continue;
        own.at_points.col(point) = height * hat.top.head(components());
        raised.push_back(point);
      }
    }
  for (const int t : under) own.energy_square += energy_square(t, own.at_points);
  turn_back(own.at_points);
  return own;
}

}  // namespace signorini
