#include "summarize.hpp"

#include <cmath>

#include <sys/resource.h>

#include "certify/certificate.hpp"
#include "contact/residuals.hpp"
#include "fem/per_shape.hpp"
#include "fem/reconstruct.hpp"
#include "flux_functional.hpp"

namespace signorini {
namespace {

Eigen::VectorXd contact_pressure(const Discretization& problem, const Eigen::MatrixXd& stress) {
  Eigen::VectorXd forces;
  contact_forces(
      problem, [&](int t) -> LocalVector { return stress.col(t); }, forces);
  return contact_pressure(problem.clearance, forces);
}

}  // namespace

Reaction make_reaction(std::string part, const std::vector<double>& values) {
  if (values.size() == 1) return {std::move(part), values, 0};
  return {std::move(part), {values[0], values[1]}, values[2]};
}

Eigen::VectorXd contact_pressure(const ClearanceSpace& space, const Eigen::VectorXd& forces) {
  Eigen::VectorXd pressure(forces.size());
  for (std::size_t i = 0; i < space.rows.size(); ++i) {
    const ClearanceRow& row = space.rows[i];
    const bool held_clear = row.unknown < 0 && row.datum > 0;
    pressure[i] = held_clear ? 0 : forces[i] / row.weight;
  }
  return pressure;
}

std::vector<ContactPart> contact_parts(const ClearanceSpace& space, const Mesh& mesh,
                                       const Eigen::VectorXd& clearance, const Eigen::VectorXd& pressure) {
  std::vector<ContactPart> parts;
  int last = -1;
  for (std::size_t i = 0; i < space.rows.size(); ++i) {
    const ClearanceRow& row = space.rows[i];
    if (row.part != last) parts.push_back({mesh.boundary[last = row.part].name, {}, {}, {}, {}, {}, {}});
    ContactPart& part = parts.back();
    part.points.push_back(row.point);
    part.clearance.push_back(clearance[i]);
    part.pressure.push_back(pressure[i]);
    part.gap.push_back(row.gap);
    part.weight.push_back(row.weight);
    part.open.push_back(clearance[i] > 0);
  }
  return parts;
}

ContactSummary sum_up(const std::vector<ContactPart>& parts) {
  ContactSummary sum;
  for (const ContactPart& part : parts)
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      sum.force += part.pressure[i] * part.weight[i];
      sum.max_pressure = std::max(sum.max_pressure, part.pressure[i]);
      if (!part.open[i]) sum.length += part.weight[i];
    }
  return sum;
}

namespace {

/// The traces m = E (M σ + Bᵀ u + Aᵀ γ) of the displacement as a triangle sees them, in x and y components.
LocalVector trace_of(const Discretization& problem, const Solution& solution, int t,
                     const ElementMatrices& matrices) {
  LocalVector term = matrices.compliance * solution.stress.col(t) +
                     problem.spaces().divergence.transpose() * solution.displacement.col(t);
  for (int z = 0; z < matrices.skew.rows(); ++z)
    term += solution.rotation[problem.mesh.triangles[t][z]] * matrices.skew.row(z).transpose();
  return term.head(problem.traces.traces_per_triangle());
}

/// <t,u> on one boundary edge.
double work_of_traction(const Discretization& problem, const Solution& solution, int edge) {
  const int t = problem.mesh.edge_triangles[edge][0], n = problem.spaces().traces_per_edge();
  const int first = problem.mesh.local_edge(t, edge) * n;
  const LocalVector trace = trace_of(problem, solution, t, problem.element.matrices(problem.mesh, t));
  double sum = 0;
  for (int j = first; j < first + n; ++j) {
    const int dof = problem.traces.dof(t, j);
    if (problem.traces.is_free(dof)) sum += problem.coupling_load[problem.traces[dof].unknown] * trace[j];
  }
  return sum;
}

/// ½(Cσ,σ) − (f,u) − <t,u>, where u turns with the rotation if the spaces leave it the couples.
double energy(const Discretization& problem, const Solution& solution) {
  double sum = 0;
  PerShape<LocalMatrix> compliances(problem);
  for (int t = 0; t < problem.triangles(); ++t) {
    const LocalMatrix& compliance =
        compliances(t, [](const ElementMatrices& matrices) { return matrices.compliance; });
    const LocalVector sigma = solution.stress.col(t);
    sum += 0.5 * sigma.dot(compliance.lazyProduct(sigma)) -
           problem.load.col(t).dot(solution.displacement.col(t));
  }
  for (const BoundaryPart& part : problem.mesh.boundary)
    for (const int edge : part.edges) sum -= work_of_traction(problem, solution, edge);
  for (int point = 0; point < solution.rotation.size(); ++point)
    sum -= problem.coupling_load[problem.traces.rotation_at(point)] * solution.rotation[point];
  return sum;
}

Reaction reaction(const Discretization& problem, const BoundaryPart& part, const Eigen::MatrixXd& stress) {
  std::vector<double> values;
  for (const FluxFunctional& functional : reactions_on(problem, part))
    values.push_back(functional(problem, stress));
  return make_reaction(part.name, values);
}

Unknowns count_unknowns(const Discretization& problem) {
  const std::int64_t edges = static_cast<std::int64_t>(problem.mesh.edges.size());
  const std::int64_t triangles = problem.triangles();
  const Spaces& spaces = problem.spaces();
  const int inner = spaces.stresses() - problem.traces.traces_per_triangle();
  return {edges * spaces.traces_per_edge() + triangles * inner, triangles * spaces.displacements(),
          problem.clearance.unknowns,
          spaces.rotations() ? static_cast<std::int64_t>(problem.mesh.points.size()) : 0};
}

}  // namespace

std::string advice(const Settings& settings, Outcome outcome, int iterations) {
  const std::string after = " after " + std::to_string(iterations) + " iterations";
  const bool paper = std::holds_alternative<PaperUzawa>(settings.method);
  const std::string faster =
      paper ? "use rho and augmentation \"auto\", or active_set" : "raise max_iterations or use active_set";
  switch (outcome) {
    case Outcome::converged:
      return "";
    case Outcome::iteration_limit:
      return "the tolerance was not met" + after + ": raise the tolerance, " + faster;
    case Outcome::time_limit:
      return "the time limit was reached" + after + ": raise solver.time_limit, or " + faster;
    case Outcome::tolerance_not_met:
    case Outcome::cancelled:
      break;  // said by the loop over meshes that ends so
    case Outcome::diverged:
      return "the Uzawa iteration diverged" + after +
             ": the step rho is too large for this mesh; it must stay below " +
             "twice the augmentation and below a bound that shrinks with the mesh; lower rho or " + faster;
  }
  return "";
}

namespace {

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

void refuse_overflow(const Solution& solution) {
  const bool finite = std::isfinite(solution.summary.energy) && solution.stress.allFinite() &&
                      solution.displacement.allFinite() && std::isfinite(solution.summary.contact.force);
  if (!finite)
    throw SolveError(
        "the numbers of this problem leave the range of double precision: choose units in which loads, "
        "moduli, lengths, rho and augmentation lie closer to 1");
}

}  // namespace

const char* name(Outcome outcome) {
  static constexpr std::array names{"converged", "iteration_limit",   "time_limit",
                                    "diverged",  "tolerance_not_met", "cancelled"};
  return names[static_cast<int>(outcome)];
}

Timings timings(const Progress& progress) {
  return {progress.seconds_in(Phase::mesh),      progress.seconds_in(Phase::assemble),
          progress.seconds_in(Phase::factorize), progress.seconds_in(Phase::iterate),
          progress.seconds_in(Phase::certify),   progress.seconds()};
}

Solution summarize(const Discretization& problem, Fields fields, const Settings& settings,
                   Progress& progress) {
  Solution solution;
  Summary& summary = solution.summary;
  solution.scheme = problem.problem.scheme;
  solution.mesh = problem.mesh;
  solution.components = problem.spaces().components;
  solution.stress = std::move(fields.stress);
  solution.displacement = std::move(fields.displacement);
  solution.rotation = problem.traces.rotation(fields.coupling);
  progress.check();
  summary.energy = energy(problem, solution);
  solution.stress_at_centroids = stress_at_centroids(problem.mesh, problem.spaces(), solution.stress);
  solution.displacement_at_points = displacement_at_points(problem.problem, solution);
  solution.out_of_plane_stress =
      out_of_plane_stress(problem.problem.material, problem.mesh, solution.stress_at_centroids);
  for (const BoundaryPart& part : problem.mesh.boundary)
    summary.parts.push_back(reaction(problem, part, solution.stress));
  const Eigen::VectorXd clearance = problem.clearance.clearance(fields.clearance);
  const Eigen::VectorXd pressure = contact_pressure(problem, solution.stress);
  solution.contact = contact_parts(problem.clearance, problem.mesh, clearance, pressure);

  summary.outcome = fields.outcome;
  summary.iterations = progress.iterations();
  summary.advice = advice(settings, fields.outcome, summary.iterations);
  summary.method = std::holds_alternative<ActiveSet>(settings.method) ? "active_set" : "uzawa";
  summary.notes = problem.mesh.notes;
  summary.triangles = problem.triangles();
  summary.unknowns = count_unknowns(problem);
  summary.contact = sum_up(solution.contact);
  progress.check();
  summary.residuals = residuals(solution, clearance, pressure, problem);
  progress.enter(Phase::certify);
  Certificate certificate = certify(problem, solution, fields.coupling, progress);
  if (std::isfinite(certificate.bound.value) && std::isfinite(certificate.bound.energy_upper)) {
    summary.error_bound = std::move(certificate.bound);
    solution.error_squares = std::move(certificate.squares);
    solution.admissible_pressure = std::move(certificate.pressure);
  }
  summary.timings = timings(progress);
  summary.peak_memory_bytes = peak_memory_bytes();
  solution.history = progress.take_history();
  refuse_overflow(solution);
  return solution;
}

}  // namespace signorini
