#include "certify/reactions/reactions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "certify/local_fields.hpp"
#include "certify/rounding.hpp"
#include "fem/cubature.hpp"
#include "fem/lagrange.hpp"
#include "mesh/parts.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// The degrees of σ_h, and of a quadratic load times a hat.
constexpr int kStress = 2, kWork = 3;

/// The component of a motion along a direction; of a membrane along x.
Extensions::Given along(const SupportMotion& motion, const Mesh& mesh) {
  return [motion, &mesh](int point, const Vector& d) { return motion(mesh.points[point]).dot(d); };
}

/// (φ, hat) for the six quadratic functions and the three hats, on the reference triangle.
Eigen::Matrix<double, 6, 3> work_on_hats() {
  Eigen::Matrix<double, 6, 3> products = Eigen::Matrix<double, 6, 3>::Zero();
  for (const auto& [point, weight] : rule_of_degree(kWork))
    products += weight * quadratic_basis(point) * triangle_basis(1, point).transpose();
  return products;
}

}  // namespace

Reactions::Reactions(const Discretization& discrete, const Solution& solution, const Extensions& extensions,
                     Progress& progress)
    : discrete_(discrete),
      solution_(solution),
      extensions_(extensions),
      work_(Eigen::MatrixXd::Zero(components(), static_cast<Eigen::Index>(discrete.mesh.points.size()))),
      size_(work_) {
  if (components() == 1)
    add_stress<1>(progress);
  else
    add_stress<2>(progress);
  for (int t = 0; t < discrete.triangles(); ++t) {
    add_load(t);
    if (const double work = discrete.body[t].uncertain_work; work > 0)
      uncertain_on_triangles_.emplace_back(t, work);
  }
  for (int edge = 0; edge < static_cast<int>(discrete.mesh.edges.size()); ++edge) {
    if (!discrete.traction.acts_on(edge)) continue;
    add_traction(edge);
    if (const double work = discrete.traction[edge].uncertain_work; work > 0)
      uncertain_on_edges_.emplace_back(edge, work);
  }
  for (const EdgePressure& own : solution.admissible_pressure)
    if (own.begin == 0 && own.end == 1) least_pressure_[own.edge] = std::min(own.at_ends[0], own.at_ends[1]);
}

void Reactions::add(int point, int component, double work) {
  work_(component, point) += work;
  size_(component, point) += std::abs(work);
}

/// The strain of a hat is constant, so that the mean of σ_h counts, and of it what is symmetric.
template <int D>
void Reactions::add_stress(Progress& progress) {
  std::vector<Point> points;
  for (const auto& [point, weight] : rule_of_degree(kStress)) points.push_back(point);
  const StressValues<D> values(discrete_.spaces(), points);
  for (int t = 0; t < discrete_.triangles(); ++t) {
    progress.check_in(t);
    const AffineMap map(discrete_.mesh.corners(t));
    Tensor<D> stress = Tensor<D>::Zero();
    for (std::size_t q = 0; q < points.size(); ++q)
      stress += rule_of_degree(kStress)[q].weight * map.determinant *
                values(static_cast<int>(q), map, solution_.stress.col(t));
    if constexpr (D == 2) stress[1] = stress[2] = (stress[1] + stress[2]) / 2;
    const Eigen::Matrix<double, 2, 3> gradients = hat_gradients(map);
    for (int z = 0; z < 3; ++z)
      for (int c = 0; c < D; ++c)
        add(discrete_.mesh.triangles[t][z], c, stress.template segment<2>(2 * c).dot(gradients.col(z)));
  }
}

/// The rest of the load is orthogonal to hats, as far as it is known.
void Reactions::add_load(int t) {
  const ProjectedLoad::Nodes& load = discrete_.body[t].projection;
  if (load.isZero(0)) return;
  static const Eigen::Matrix<double, 6, 3> products = work_on_hats();
  const double twice_area = AffineMap(discrete_.mesh.corners(t)).determinant;
  for (int c = 0; c < components(); ++c)
    for (int z = 0; z < 3; ++z)
      add(discrete_.mesh.triangles[t][z], c, -twice_area * load.row(c).dot(products.col(z)));
}

void Reactions::add_traction(int edge) {
  for (int q = 0; q < EdgeRule::size; ++q) {
    const double s = edge_rule().points[q], share = edge_rule().weights[q] * discrete_.mesh.length(edge);
    for (int c = 0; c < components(); ++c)
      for (int end = 0; end < 2; ++end)
        add(discrete_.mesh.edges[edge][end], c,
            -share * (end == 0 ? 1 - s : s) * discrete_.traction(edge, c, s));
  }
}

/// The work of what is not known of the loads is no more.
double Reactions::uncertain_work(const Eigen::MatrixXd& at_points) const {
  const Mesh& mesh = discrete_.mesh;
  const auto largest = [&](const auto& points) {
    double most = 0;
    for (const int point : points) most = std::max(most, at_points.col(point).norm());
    return most;
  };
  double sum = 0;
  for (const auto& [t, work] : uncertain_on_triangles_) sum += work * largest(mesh.triangles[t]);
  for (const auto& [edge, work] : uncertain_on_edges_) sum += work * largest(mesh.edges[edge]);
  return sum;
}

/// THEORY.md, Theorem 5.
EnclosedNumber Reactions::enclose(const Extension& extension, double value) const {
  const Eigen::MatrixXd& w = extension.at_points;
  const double middle = work_.cwiseProduct(w).sum();
  const double radius = solution_.summary.error_bound->value * std::sqrt(extension.energy_square) +
                        uncertain_work(w) + kRoundingOfSums * size_.cwiseProduct(w.cwiseAbs()).sum();
  return enclosed_number(value, middle - radius, middle + radius);
}

/// Those whose works are the numbers of a Reaction.
std::vector<SupportMotion> Reactions::motions() const {
  if (components() == 1) return {{Vector::UnitX(), 0}};
  return {{Vector::UnitX(), 0}, {Vector::UnitY(), 0}, {Vector::Zero(), 1}};
}

CertifiedSupport Reactions::of(const std::vector<int>& parts, std::vector<Extension::Clash>& clashes,
                               Progress& progress) const {
  CertifiedSupport own;
  for (const int part : parts) own.parts.push_back(discrete_.mesh.boundary[part].name);
  const std::vector<SupportMotion> all = motions();
  for (std::size_t i = 0; i < all.size(); ++i) {
    double value = 0;
    for (const int part : parts) {
      const Reaction& reaction = solution_.summary.parts[part];
      value += i < reaction.force.size() ? reaction.force[i] : reaction.moment;
    }
    const Extensions::Given motion = along(all[i], discrete_.mesh);
    const std::vector<Extension::Clash> own_clashes = extensions_.clashes(parts, motion);
    clashes.insert(clashes.end(), own_clashes.begin(), own_clashes.end());
    const bool is_bounded = own_clashes.empty();
    const EnclosedNumber number =
        is_bounded ? enclose(extensions_(parts, motion, progress), value) : EnclosedNumber{value, value};
    if (i < 2)
      own.force.push_back(number);
    else if (is_bounded)
      own.moment = number;
  }
  return own;
}

/// ∫ p over a contact part. Where another support contradicts, the weight falls to 0 in the last edge: that
/// is a bound from below.
EnclosedNumber Reactions::pressure_force(int part, Progress& progress) const {
  const auto& rows =
      *std::ranges::find(solution_.contact, discrete_.mesh.boundary[part].name, &ContactPart::name);
  double value = 0;
  for (std::size_t i = 0; i < rows.pressure.size(); ++i) value += rows.pressure[i] * rows.weight[i];
  const double sign = components() == 1 ? 1 : -1;
  const Extension extension = extensions_(
      {part}, [sign](int, const Vector&) { return sign; }, progress);
  EnclosedNumber own = enclose(extension, value);
  own.lower = std::max(0., own.lower);
  if (!extension.clashes.empty()) own.upper = std::numeric_limits<double>::infinity();
  return enclosed_number(value, own.lower, own.upper);
}

/// ∫ w p over a contact part, w ≥ 0 by its values in the points; the hat is for those beside the part.
EnclosedNumber Reactions::force_under(int part, Extensions::Hat hat,
                                      const std::function<double(int point)>& weight) const {
  const double sign = components() == 1 ? 1 : -1;
  hat.top *= sign;
  const Extension extension = extensions_.tent(
      part, [&](int point, const Vector&) { return sign * weight(point); }, hat);
  EnclosedNumber own = enclose(extension, 0);
  if (!extension.clashes.empty()) own.upper = std::numeric_limits<double>::infinity();
  return own;
}

/// Of a stretch a hat within tells whether it touches, and one around what it carries.
CertifiedStretch Reactions::stretch(int part, std::span<const std::array<int, 2>> ways,
                                    std::span<const int> edges) const {
  const Mesh& mesh = discrete_.mesh;
  std::set<int> within, around{ways.back()[1]};
  for (const auto& [from, to] : ways) around.insert(from);
  for (const auto& [from, to] : ways.subspan(1)) within.insert(from);
  const auto point = [&](std::size_t i) -> const Point& {
    return mesh.points[i < ways.size() ? ways[i][0] : ways.back()[1]];
  };
  const std::size_t n = ways.size();
  CertifiedStretch own{point(0), point(n), false, {}, {}};
  const double length = (own.end - own.begin).norm();
  const auto* contact = condition_on<Contact>(discrete_.problem, mesh.boundary[part].name);
  const Vector top = components() == 1 ? Vector(Vector::UnitX())
                                       : contact->unit_direction(mesh.outward_normal(edges[n / 2]));
  if (n >= 2 && length > 0) {
    const Point first = own.begin + (own.end - own.begin) / 4, last = own.end - (own.end - own.begin) / 4;
    const Extensions::Hat inner{first, last, length / 4, top};
    own.touches = force_under(part, inner, [&](int x) {
                    return within.contains(x) ? inner(mesh.points[x]) : 0;
                  }).lower > 0;
    const Extensions::Hat outer{own.begin, own.end, length / 2, top};
    const EnclosedNumber force =
        force_under(part, outer, [&](int x) { return around.contains(x) ? 1 : outer(mesh.points[x]); });
    if (force.has_upper()) own.carries_at_most = std::max(0., force.upper);
  }
  own.opens_at_most = most_opening(edges);
  return own;
}

std::vector<CertifiedStretch> Reactions::stretches(int part) const {
  constexpr std::size_t most = 8, least_edges = 4;
  const BoundaryPart& boundary = discrete_.mesh.boundary[part];
  const std::vector<std::array<int, 2>> ways = directed_edges(discrete_.mesh, boundary);
  const std::size_t length = std::max(least_edges, (ways.size() + most - 1) / most);
  std::vector<CertifiedStretch> all;
  for (std::size_t begin = 0, end = 0; begin < ways.size(); begin = end) {
    for (end = begin + 1; end < ways.size() && end - begin < length; ++end)
      if (ways[end][0] != ways[end - 1][1]) break;
    all.push_back(stretch(part, std::span(ways).subspan(begin, end - begin),
                          std::span(boundary.edges).subspan(begin, end - begin)));
  }
  return all;
}

/// ∫ p* (g − u_n) is at most R²/4, which says nothing where p* is rounding beside its largest. Without Γ_D
/// the pressure may change to carry what is not known of the loads.
std::optional<double> Reactions::most_opening(std::span<const int> edges) const {
  const auto& boundary = discrete_.problem.boundary;
  if (std::ranges::none_of(boundary,
                           [](const auto& own) { return std::holds_alternative<Fixed>(own.second); }))
    return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  for (const int edge : edges) {
    const auto own = least_pressure_.find(edge);
    least = std::min(least, own == least_pressure_.end() ? 0 : own->second);
  }
  constexpr double rounding = 1e-9;
  double largest = 0;
  for (const auto& [edge, pressure] : least_pressure_) largest = std::max(largest, pressure);
  if (!(least > rounding * largest)) return std::nullopt;
  const ErrorBound& bound = *solution_.summary.error_bound;
  const double energies = bound.energy_upper - bound.energy_lower, contact = bound.parts.contact;
  return (2 * energies + contact * contact) / 4 / least;
}

namespace {

std::string in_words(const Extension::Clash& clash, const Mesh& mesh) {
  const std::string &part = mesh.boundary[clash.part].name, &other = mesh.boundary[clash.other].name;
  return part + " and " + other + " meet at " + to_string(mesh.points[clash.point]) +
         ", and how they share out what acts there is not bounded by any bound of the energy: see what both "
         "take together, or ask for a quantity whose weight vanishes there";
}

/// Joins the groups of parts that clash.
void join(const std::vector<Extension::Clash>& clashes, std::vector<std::vector<int>>& groups) {
  const auto group_of = [&](int part) {
    return std::ranges::find_if(groups,
                                [part](const auto& own) { return std::ranges::count(own, part) > 0; });
  };
  for (const Extension::Clash& clash : clashes) {
    const auto one = group_of(clash.part), other = group_of(clash.other);
    if (one == other) continue;
    one->insert(one->end(), other->begin(), other->end());
    std::ranges::sort(*one);
    groups.erase(other);
  }
}

}  // namespace

CertifiedSupport Reactions::of(int part, std::vector<Extension::Clash>& clashes, Progress& progress) const {
  CertifiedSupport own = of(std::vector{part}, clashes, progress);
  if (!condition_on<Contact>(discrete_.problem, discrete_.mesh.boundary[part].name)) return own;
  // What presses a membrane is what supports it.
  const EnclosedNumber& force = own.force[0];
  own.pressure_force = components() == 1 && force.is_bounded()
                           ? enclosed_number(force.value, std::max(0., force.lower), force.upper)
                           : pressure_force(part, progress);
  own.stretches = stretches(part);
  return own;
}

std::vector<CertifiedSupport> Reactions::all(std::vector<std::string>& unmet, Progress& progress) const {
  const std::vector<int>& supports = extensions_.supports();
  std::vector<CertifiedSupport> all(supports.size());
  std::vector<std::vector<Extension::Clash>> clashes_of(supports.size());
  side_by_side(static_cast<int>(supports.size()), progress,
               [&](int i, Progress& its) { all[i] = of(supports[i], clashes_of[i], its); });
  std::vector<std::vector<int>> groups;
  std::vector<Extension::Clash> clashes;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    groups.push_back({supports[i]});
    clashes.insert(clashes.end(), clashes_of[i].begin(), clashes_of[i].end());
  }
  join(clashes, groups);
  for (const std::vector<int>& parts : groups)
    if (parts.size() > 1) all.push_back(of(parts, clashes, progress));
  std::set<std::array<int, 2>> told;
  for (const Extension::Clash& clash : clashes)
    if (told.insert({std::min(clash.part, clash.other), std::max(clash.part, clash.other)}).second)
      unmet.push_back(in_words(clash, discrete_.mesh));
  return all;
}

}  // namespace signorini
