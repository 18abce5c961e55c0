#include "contact/residuals.hpp"

#include <cmath>

#include <Eigen/LU>

#include "fem/per_shape.hpp"
#include "progress/in_parts.hpp"

namespace signorini {
namespace {

/// value / scale; of nothing, nothing is 0 and anything is all of it.
double relative(double value, double scale) {
  if (value == 0) return 0;
  return scale > 0 ? value / scale : 1;
}

/// Displacements below this part of the clearances are rounding.
constexpr double kSmall = 1e-12;

double largest_entry(const Eigen::VectorXd& values) {
  return values.size() > 0 ? values.lpNorm<Eigen::Infinity>() : 0;
}

/// ‖σ_h‖ in L2, gathered triangle by triangle, and the sizes that tell it from rounding.
class StressNorm {
 public:
  explicit StressNorm(const Eigen::VectorXd& clearance)
      : clearance_(largest_entry(clearance)), largest_term_(kSmall * clearance_) {}

  /// `strain` is M σ and `rise` Bᵀ u, the terms of the first equation.
  void add(const LocalMatrix& compliance, const LocalMatrix& stress_mass, const LocalVector& sigma,
           const LocalVector& strain, const LocalVector& rise) {
    square_ += sigma.dot(stress_mass.lazyProduct(sigma));
    largest_term_ =
        std::max({largest_term_, strain.lpNorm<Eigen::Infinity>(), rise.lpNorm<Eigen::Infinity>()});
    largest_compliance_ = std::max(largest_compliance_, compliance.diagonal().maxCoeff());
  }

  void add(const StressNorm& of_others) {
    square_ += of_others.square_;
    largest_term_ = std::max(largest_term_, of_others.largest_term_);
    largest_compliance_ = std::max(largest_compliance_, of_others.largest_compliance_);
  }

  double largest_term() const { return largest_term_; }

  /// A small part of ‖σ‖ for displacements of the same size that strain the body as a whole: the diagonal of
  /// M is a compliance.
  double no_stress() const { return small_part_for(largest_term_); }

  /// ‖σ_h‖, or what counts as no stress at all.
  double value() const { return std::max(std::sqrt(square_), no_stress()); }

  /// The same beside pressures, which have the rounding of clearances too.
  double value_beside_pressures() const { return std::max(value(), small_part_for(clearance_)); }

 private:
  double small_part_for(double length) const { return 1e-4 * relative(length, largest_compliance_); }

  double clearance_, largest_term_, square_ = 0, largest_compliance_ = 0;
};

/// What the residuals of equilibrium, of the constitutive law and of symmetry need of some triangles.
class BalanceOfPart {
 public:
  BalanceOfPart(const Solution& solution, const Eigen::VectorXd& clearance, const Discretization& discrete,
                Part own, Progress& progress)
      : part(own), norm(clearance), solution_(solution), discrete_(discrete), shapes_(discrete) {
    const Eigen::Index triangles = part.end - part.begin, traces = discrete.traces.traces_per_triangle();
    flux.resize(traces, triangles);
    trace.resize(traces, triangles);
    if (discrete.spaces().rotations()) {
      skew.resize(3, triangles);
      skew_terms.resize(3, triangles);
    }
    for (int t = part.begin; t < part.end; ++t) {
      progress.check_in(t);
      add_triangle(t);
    }
  }

  const Part part;
  double imbalance_square = 0, load_square = 0, interior = 0;
  StressNorm norm;
  // A column a triangle.
  Eigen::MatrixXd flux, trace;        ///< in the components of its edges
  Eigen::Matrix3Xd skew, skew_terms;  ///< at its corners; of an elastic body

 private:
  struct Shape {
    ElementMatrices matrices;
    LocalMatrix mass_inverse;
    LocalMatrix stress_mass;
  };

  void add_triangle(int t) {
    const Shape& shape = shapes_(t, [&](const ElementMatrices& matrices) -> Shape {
      const LocalMatrix& mass = matrices.displacement_mass;
      return {matrices, mass.inverse(), discrete_.element.stress_mass(discrete_.mesh, t)};
    });
    const ElementMatrices& matrices = shape.matrices;
    const LocalVector load = discrete_.load.col(t);
    const LocalVector sigma = solution_.stress.col(t), u = solution_.displacement.col(t);
    const LocalMatrix& b = discrete_.spaces().divergence;
    const LocalVector imbalance = b.lazyProduct(sigma) + load;
    imbalance_square += imbalance.dot(shape.mass_inverse.lazyProduct(imbalance));
    load_square += load.dot(shape.mass_inverse.lazyProduct(load));

    // M σ + Bᵀ u + Aᵀ γ is m on the edges (seen from this side), and 0 for the functions without flux.
    const LocalVector strain = matrices.compliance.lazyProduct(sigma), rise = b.transpose().lazyProduct(u);
    norm.add(matrices.compliance, shape.stress_mass, sigma, strain, rise);
    LocalVector term = strain + rise;
    for (int z = 0; z < matrices.skew.rows(); ++z) add_corner(t, z, matrices.skew.row(z), sigma, term);
    const int n = discrete_.traces.traces_per_triangle();
    if (term.size() > n) interior = std::max(interior, term.tail(term.size() - n).lpNorm<Eigen::Infinity>());
    set_edges(t, sigma.head(n), term.head(n));
  }

  void add_corner(int t, int z, const LocalVector& of_corner, const LocalVector& sigma, LocalVector& term) {
    term += solution_.rotation[discrete_.mesh.triangles[t][z]] * of_corner;
    skew(z, t - part.begin) = of_corner.dot(sigma);
    skew_terms(z, t - part.begin) = of_corner.cwiseAbs().dot(sigma.cwiseAbs());
  }

  void set_edges(int t, LocalVector own_flux, LocalVector own_trace) {
    if (discrete_.traces.is_turned(t)) {
      const Eigen::Index n = own_flux.size();
      const LocalMatrix map = discrete_.traces.to_xy(t).topLeftCorner(n, n);
      own_flux = (map.transpose() * own_flux).eval();
      own_trace = (map.transpose() * own_trace).eval();
    }
    flux.col(t - part.begin) = own_flux;
    trace.col(t - part.begin) = own_trace;
  }

  const Solution& solution_;
  const Discretization& discrete_;
  PerShape<Shape> shapes_;
};

/// The same of all triangles, and on their edges and points what those on both sides have.
class Balance {
 public:
  Balance(const Solution& solution, const Eigen::VectorXd& clearance, const Discretization& discrete,
          Progress& progress)
      : discrete_(discrete),
        per_edge_(discrete.spaces().traces_per_edge()),
        traces_(static_cast<int>(discrete.mesh.edges.size()) * per_edge_),
        flux_(Eigen::VectorXd::Zero(traces_)),
        trace_(Eigen::VectorXd::Zero(traces_)),
        skew_(Eigen::VectorXd::Zero(discrete.mesh.points.size())),
        skew_terms_(skew_),
        norm_(clearance) {
    in_parts(
        discrete.triangles(), progress,
        [&](Part part, Progress& own) { return BalanceOfPart(solution, clearance, discrete, part, own); },
        [this](const BalanceOfPart& of_part) { add(of_part); });
    compare_with_boundary(clearance);
    for (int point = 0; point < solution.rotation.size(); ++point)
      skew_[point] += discrete.coupling_load[discrete.traces.rotation_at(point)];
  }

  double stress_norm() const { return norm_.value(); }
  double stress_norm_beside_pressures() const { return norm_.value_beside_pressures(); }

  double equilibrium() const {
    const double size = std::sqrt(discrete_.mesh.area());
    const double volume =
        relative(std::sqrt(imbalance_square_), std::sqrt(load_square_) + stress_norm() / size);
    return std::max(volume,
                    relative(flux_.lpNorm<Eigen::Infinity>(), std::max(largest_flux_, norm_.no_stress())));
  }

  double constitutive() const {
    return relative(std::max(trace_.lpNorm<Eigen::Infinity>(), interior_), norm_.largest_term());
  }

  double symmetry() const {
    const double edge = std::sqrt(discrete_.mesh.area() / discrete_.triangles());
    return relative(skew_.lpNorm<Eigen::Infinity>(),
                    std::max(skew_terms_.lpNorm<Eigen::Infinity>(), edge * norm_.no_stress()));
  }

 private:
  void add(const BalanceOfPart& own) {
    imbalance_square_ += own.imbalance_square;
    load_square_ += own.load_square;
    interior_ = std::max(interior_, own.interior);
    norm_.add(own.norm);
    for (int t = own.part.begin; t < own.part.end; ++t) {
      const Eigen::Index column = t - own.part.begin;
      add_on_edges(t, own.flux.col(column), own.trace.col(column));
      if (own.skew.cols() > 0) add_at_corners(t, own.skew.col(column), own.skew_terms.col(column));
    }
  }

  void add_at_corners(int t, const Eigen::Vector3d& skew, const Eigen::Vector3d& terms) {
    for (int z = 0; z < 3; ++z) {
      const int point = discrete_.mesh.triangles[t][z];
      skew_[point] += skew[z];
      skew_terms_[point] += terms[z];
    }
  }

  template <typename Column>
  void add_on_edges(int t, const Column& flux, const Column& trace) {
    for (int j = 0; j < flux.size(); ++j) {
      const int dof = discrete_.traces.dof(t, j);
      const bool first = discrete_.mesh.edge_triangles[dof / per_edge_][0] == t;
      flux_[dof] += flux[j];
      trace_[dof] += first ? trace[j] : -trace[j];
      largest_flux_ = std::max(largest_flux_, std::abs(flux[j]));
    }
  }

  /// A boundary edge has no other side. Where a component of m is free (Γ_F, and tangentially Γ_C and
  /// rollers) the flux is t, and the trace is not tested, for τ n = 0 there; elsewhere the flux is free and
  /// the trace is data or the clearance.
  void compare_with_boundary(const Eigen::VectorXd& clearance) {
    const TraceSpace& traces = discrete_.traces;
    for (int dof = 0; dof < traces_; ++dof) {
      if (discrete_.mesh.edge_triangles[dof / per_edge_][1] >= 0) continue;
      if (traces.is_free(dof)) {
        flux_[dof] -= discrete_.coupling_load[traces[dof].unknown];
        trace_[dof] = 0;
      } else {
        flux_[dof] = 0;
        trace_[dof] -= traces[dof].datum;
      }
    }
    for (const ContactEdge& contact : discrete_.clearance.edges)
      for (int j = 0; j <= discrete_.spaces().order; ++j) {
        const int dof = contact.edge * per_edge_ + j * discrete_.spaces().components, row = contact.rows[j];
        if (discrete_.clearance.rows[row].unknown >= 0) trace_[dof] -= traces[dof].sign * clearance[row];
      }
  }

  const Discretization& discrete_;
  int per_edge_;
  int traces_;                  ///< degrees of freedom of m
  Eigen::VectorXd flux_;        ///< sum of the outward fluxes of both sides
  Eigen::VectorXd trace_;       ///< difference of the traces seen from both sides
  Eigen::VectorXd skew_;        ///< (as σ, φ_z) and the couple for each point
  Eigen::VectorXd skew_terms_;  ///< the sums of the sizes of the terms of (as σ, φ_z)
  double interior_ = 0;
  StressNorm norm_;
  double imbalance_square_ = 0, load_square_ = 0;
  double largest_flux_ = 0;
};

}  // namespace

ContactResiduals contact_residuals(const Eigen::VectorXd& clearance, const Eigen::VectorXd& pressure,
                                   const Eigen::VectorXd& weight, double mean_stress) {
  if (clearance.size() == 0) return {};
  const double scale = std::max(mean_stress, pressure.lpNorm<Eigen::Infinity>());
  const double weighted = weight.dot(clearance.cwiseAbs());
  return {relative(std::max(0., -clearance.minCoeff()), clearance.lpNorm<Eigen::Infinity>()),
          relative(std::max(0., -pressure.minCoeff()), scale),
          relative(weight.dot(clearance.cwiseProduct(pressure).cwiseAbs()), weighted * scale)};
}

double mean_stress(const Discretization& discrete, const Eigen::MatrixXd& stress,
                   const Eigen::MatrixXd& displacement, const Eigen::VectorXd& clearance) {
  struct Shape {
    LocalMatrix compliance, stress_mass;
  };
  StressNorm norm(clearance);
  PerShape<Shape> shapes(discrete);
  const LocalMatrix& b = discrete.spaces().divergence;
  for (int t = 0; t < discrete.triangles(); ++t) {
    const Shape& shape = shapes(t, [&](const ElementMatrices& matrices) -> Shape {
      return {matrices.compliance, discrete.element.stress_mass(discrete.mesh, t)};
    });
    const LocalVector sigma = stress.col(t), u = displacement.col(t);
    norm.add(shape.compliance, shape.stress_mass, sigma, shape.compliance.lazyProduct(sigma),
             b.transpose().lazyProduct(u));
  }
  return norm.value_beside_pressures() / std::sqrt(discrete.mesh.area());
}

double relative_change(const Eigen::Ref<const Eigen::MatrixXd>& last,
                       const Eigen::Ref<const Eigen::MatrixXd>& next) {
  return relative((next - last).lpNorm<1>(), next.lpNorm<1>());
}

Residuals residuals(const Solution& solution, const Eigen::VectorXd& clearance,
                    const Eigen::VectorXd& pressure, const Discretization& discrete, Progress& progress) {
  const Balance balance(solution, clearance, discrete, progress);
  std::vector<int> tested;
  Eigen::VectorXd weight(clearance.size());
  for (int i = 0; i < static_cast<int>(weight.size()); ++i) {
    weight[i] = discrete.clearance.rows[i].weight;
    if (discrete.clearance.rows[i].unknown >= 0) tested.push_back(i);
  }
  const ContactResiduals contact =
      contact_residuals(clearance(tested), pressure(tested), weight(tested),
                        balance.stress_norm_beside_pressures() / std::sqrt(discrete.mesh.area()));
  return {balance.equilibrium(), balance.constitutive(),  contact.penetration,
          contact.tension,       contact.complementarity, balance.symmetry()};
}

}  // namespace signorini
