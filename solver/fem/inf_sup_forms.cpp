#include "fem/inf_sup_forms.hpp"

#include <array>
#include <cmath>
#include <vector>

#include <Eigen/LU>

#include "fem/element.hpp"
#include "fem/lagrange.hpp"
#include "fem/trace_space.hpp"

namespace signorini {
namespace {

/// The problem with the data that its spaces depend on alone: C = 1, so that (C σ, τ) = (σ, τ).
Problem with_unit_material(Problem problem) {
  if (components(problem.material) == 1)
    problem.material = MembraneStiffness::isotropic(Field(1));
  else
    problem.material = YoungPoisson{Field(1), Field(0)};
  return problem;
}

Mesh of_unit_area(Mesh mesh) {
  const double length = std::sqrt(mesh.area());
  for (Point& point : mesh.points) point /= length;
  return mesh;
}

/// Entries of a symmetric matrix, whose lower triangle is kept.
class Form {
 public:
  void add(int row, int column, double value) {
    if (row >= 0 && column >= 0 && row >= column) entries_.emplace_back(row, column, value);
  }
  Eigen::SparseMatrix<double> matrix(int size) const {
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    return matrix;
  }

 private:
  std::vector<Eigen::Triplet<double>> entries_;
};

/// Numbers the unknowns of all fields: σ, then v, γ and μ, then the extension w of μ.
class Numbering {
 public:
  Numbering(const Spaces& spaces, const Mesh& mesh, const TraceSpace& traces, Bubbles bubbles)
      : spaces_(spaces),
        mesh_(mesh),
        traces_(traces),
        functions_(bubbles == Bubbles::left_out && spaces.order == 0 ? traces.traces_per_triangle()
                                                                     : spaces.stresses()),
        fluxes_(mesh.edges.size() * spaces.traces_per_edge(), -1) {
    const int triangles = static_cast<int>(mesh.triangles.size());
    for (int t = 0; t < triangles; ++t)
      for (int j = 0; j < traces.traces_per_triangle(); ++j) {
        int& flux = fluxes_[traces.dof(t, j)];
        if (flux < 0 && carries_flux(t, j)) flux = v_++;
      }
    inner_ = v_;
    v_ += triangles * (functions_ - traces.traces_per_triangle());
    gamma_ = v_ + triangles * spaces.displacements();
    mu_ = gamma_ + traces.rotations();
    w_ = mu_ + traces.contact_unknowns();
    size_ = w_ + static_cast<int>(mesh.points.size()) * spaces.components;
  }

  /// The functions of a triangle's stress.
  int functions() const { return functions_; }
  /// Of a flux in the components that its edge carries, or of an inner function; -1 where it is prevented.
  int sigma(int triangle, int j) const {
    const int fluxes = traces_.traces_per_triangle();
    if (j < fluxes) return fluxes_[traces_.dof(triangle, j)];
    return inner_ + triangle * (functions_ - fluxes) + j - fluxes;
  }
  /// Of the flux along the direction of a contact edge.
  int normal_flux(int edge, int function) const {
    return fluxes_[edge * spaces_.traces_per_edge() + function * spaces_.components];
  }
  int v(int triangle, int i) const { return v_ + triangle * spaces_.displacements() + i; }
  int gamma(int point) const { return gamma_ + point; }
  int mu(int unknown) const { return unknown < 0 ? -1 : mu_ + unknown; }
  int w(int point, int component) const { return w_ + point * spaces_.components + component; }

  int stresses() const { return v_; }
  int multipliers() const { return w_ - v_; }
  int extensions() const { return size_ - w_; }
  int size() const { return size_; }

 private:
  /// None on Γ_F, and only along the direction of contact and rollers: there the traces are free.
  bool carries_flux(int triangle, int j) const {
    const int edge = mesh_.triangle_edges[triangle][j / spaces_.traces_per_edge()];
    return mesh_.edge_triangles[edge][1] >= 0 || !traces_.is_free(traces_.dof(triangle, j));
  }

  const Spaces& spaces_;
  const Mesh& mesh_;
  const TraceSpace& traces_;
  int functions_;
  std::vector<int> fluxes_;
  int inner_ = 0, v_ = 0, gamma_ = 0, mu_ = 0, w_ = 0, size_ = 0;
};

/// Adds the forms up on the mesh of area 1. The spaces themselves are numbered on the mesh as it is, whose
/// data can be read there alone.
class FormBuilder {
 public:
  FormBuilder(const Problem& problem, const Mesh& mesh, Bubbles bubbles, Progress& progress)
      : problem_(with_unit_material(problem)),
        mesh_(of_unit_area(mesh)),
        element_(problem_),
        clearance_(make_clearance_space(problem, mesh)),
        traces_(problem, mesh, clearance_),
        numbering_(element_.spaces(), mesh, traces_, bubbles) {
    for (int t = 0; t < static_cast<int>(mesh_.triangles.size()); ++t) {
      progress.check_in(t);
      add_triangle(t);
      add_extension(t);
    }
    for (const ContactEdge& contact : clearance_.edges) add_contact(contact);
    for (const BoundaryPart& part : mesh_.boundary) add_held(part);
  }

  InfSupForms take() const {
    return {coupled_.matrix(numbering_.size()), norms_.matrix(numbering_.size()), numbering_.stresses(),
            numbering_.multipliers(), numbering_.extensions()};
  }

 private:
  const Spaces& spaces() const { return element_.spaces(); }

  /// The fluxes that the unknowns of σ make on a triangle, outward and in x and y components, by columns.
  LocalMatrix fluxes(int t) const {
    const int edges = traces_.traces_per_triangle();
    LocalMatrix map = LocalMatrix::Identity(numbering_.functions(), numbering_.functions());
    if (traces_.is_turned(t)) map.topLeftCorner(edges, edges) = traces_.to_xy(t).topLeftCorner(edges, edges);
    for (int j = 0; j < edges; ++j)
      if (mesh_.edge_triangles[mesh_.triangle_edges[t][j / spaces().traces_per_edge()]][0] != t)
        map.col(j) *= -1;
    return map;
  }

  /// (σ, τ) + (div σ, div τ), (div τ, v) and (τ_xy − τ_yx, γ); the squares of v and γ in L².
  void add_triangle(int t) {
    const int n = numbering_.functions();
    const LocalMatrix map = fluxes(t);
    const ElementMatrices own = element_.matrices(mesh_, t);
    const LocalMatrix div = spaces().divergence.leftCols(n) * map, skew = own.skew.leftCols(n) * map;
    const LocalMatrix product = map.transpose() * own.compliance.topLeftCorner(n, n) * map +
                                div.transpose() * own.displacement_mass.inverse() * div;
    for (int j = 0; j < n; ++j) {
      const int sigma = numbering_.sigma(t, j);
      for (int i = 0; i < n; ++i) coupled_.add(numbering_.sigma(t, i), sigma, product(i, j));
      for (int i = 0; i < div.rows(); ++i) coupled_.add(numbering_.v(t, i), sigma, div(i, j));
      for (int z = 0; z < skew.rows(); ++z)
        coupled_.add(numbering_.gamma(mesh_.triangles[t][z]), sigma, skew(z, j));
    }
    for (int i = 0; i < spaces().displacements(); ++i)
      for (int j = 0; j < spaces().displacements(); ++j)
        norms_.add(numbering_.v(t, i), numbering_.v(t, j), own.displacement_mass(i, j));
    if (skew.rows() == 0) return;
    const Eigen::Matrix3d hats = mass(t);
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        norms_.add(numbering_.gamma(mesh_.triangles[t][y]), numbering_.gamma(mesh_.triangles[t][z]),
                   hats(y, z));
  }

  /// (φ_y, φ_z) of the hats of a triangle.
  Eigen::Matrix3d mass(int t) const {
    const double area = AffineMap(mesh_.corners(t)).determinant / 2;
    return area / 12 * (Eigen::Matrix3d::Ones() + Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  }

  /// ‖w‖² + ‖∇w‖².
  void add_extension(int t) {
    const AffineMap map(mesh_.corners(t));
    const Eigen::Matrix<double, 2, 3> gradients = hat_gradients(map);
    const Eigen::Matrix3d form = mass(t) + map.determinant / 2 * gradients.transpose() * gradients;
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        for (int c = 0; c < spaces().components; ++c)
          norms_.add(numbering_.w(mesh_.triangles[t][y], c), numbering_.w(mesh_.triangles[t][z], c),
                     form(y, z));
  }

  /// <τ_n, μ>: a flux is dual to the function of its edge.
  void add_contact(const ContactEdge& contact) {
    std::array<int, 2> mu;
    for (int end = 0; end < 2; ++end) mu[end] = numbering_.mu(clearance_.rows[contact.rows[end]].unknown);
    for (int j = 0; j <= spaces().order; ++j) coupled_.add(mu[j], numbering_.normal_flux(contact.edge, j), 1);
    add_difference(contact.edge, contact.direction, mu);
  }

  void add_held(const BoundaryPart& part) {
    const bool fixed = condition_on<Fixed>(problem_, part.name);
    const bool rolls = condition_on<Roller>(problem_, part.name);
    for (const int edge : part.edges) {
      if (rolls) add_difference(edge, mesh_.outward_normal(edge), {-1, -1});
      for (int c = 0; fixed && c < spaces().components; ++c) add_difference(edge, Vector::Unit(c), {-1, -1});
    }
  }

  /// ‖w_d − μ‖² / h over an edge, for the values μ at its ends.
  void add_difference(int edge, Vector direction, const std::array<int, 2>& mu) {
    if (spaces().components == 1) direction = Vector::UnitX();
    struct Term {
      int number;
      double factor;
    };
    std::array<std::vector<Term>, 2> difference;
    for (int end = 0; end < 2; ++end) {
      for (int c = 0; c < spaces().components; ++c)
        difference[end].push_back({numbering_.w(mesh_.edges[edge][end], c), direction[c]});
      difference[end].push_back({mu[end], -1});
    }
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j)
        for (const Term& a : difference[i])
          for (const Term& b : difference[j])
            norms_.add(a.number, b.number, (i == j ? 2 : 1) / 6. * a.factor * b.factor);
  }

  const Problem problem_;
  const Mesh mesh_;
  const Element element_;
  const ClearanceSpace clearance_;
  const TraceSpace traces_;
  const Numbering numbering_;
  Form coupled_, norms_;
};

}  // namespace

InfSupForms inf_sup_forms(const Problem& problem, const Mesh& mesh, Bubbles bubbles, Progress& progress) {
  return FormBuilder(problem, mesh, bubbles, progress).take();
}

}  // namespace signorini
