#include "summarize.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "certify/certificate.hpp"
#include "contact/residuals.hpp"
#include "curve_notes.hpp"
#include "fem/per_shape.hpp"
#include "fem/reconstruct.hpp"
#include "flux_functional.hpp"
#include "in_range.hpp"
#include "outcome.hpp"
#include "progress/overflow.hpp"
#include "strain_notes.hpp"

namespace signorini {
namespace {

Eigen::VectorXd contact_pressure(const Discretization& discrete, const Eigen::MatrixXd& stress) {
  Eigen::VectorXd forces;
  contact_forces(
      discrete, [&](int t) -> LocalVector { return stress.col(t); }, forces);
  return contact_pressure(discrete.clearance, forces);
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

namespace {

/// The closed rows that share a node of an arc get the pressure against the whole hat function of the node.
///
/// The direction of contact is that of each chord, and turns at its ends by the angle h/R; the arc's turns
/// steadily. So the chords hold a body that slides by u_t back at one end and push it on at the other, by
/// u_t h/2R over the length h: a pressure of E u_t/R that falls along every chord, however short, and is 0 in
/// the mean.
Eigen::VectorXd averaged_on_arcs(const ClearanceSpace& space, const Mesh& mesh,
                                 const Eigen::VectorXd& clearance, Eigen::VectorXd pressure) {
  std::map<std::pair<int, int>, std::set<int>> rows_at;  // by part and node
  for (const ContactEdge& contact : space.edges)
    for (int k = 0; k < 2; ++k) {
      const int row = contact.rows[k];
      if (mesh.circle_of(contact.edge) >= 0 && contact.rows[0] != contact.rows[1] && clearance[row] <= 0)
        rows_at[{space.rows[row].part, mesh.edges[contact.edge][k]}].insert(row);
    }
  for (const auto& [node, rows] : rows_at) {
    double force = 0, weight = 0;
    for (const int row : rows) {
      force += pressure[row] * space.rows[row].weight;
      weight += space.rows[row].weight;
    }
    for (const int row : rows) pressure[row] = force / weight;
  }
  return pressure;
}

}  // namespace

std::vector<ContactPart> contact_parts(const ClearanceSpace& space, const Mesh& mesh,
                                       const Eigen::VectorXd& clearance, const Eigen::VectorXd& by_rows) {
  const Eigen::VectorXd pressure = averaged_on_arcs(space, mesh, clearance, by_rows);
  std::vector<ContactPart> parts;
  int last = -1;
  for (std::size_t i = 0; i < space.rows.size(); ++i) {
    const ClearanceRow& row = space.rows[i];
    if (row.part != last) parts.push_back({mesh.boundary[last = row.part].name, {}, {}, {}, {}, {}, {}});
    ContactPart& part = parts.back();
    part.points.push_back(row.point);
    part.clearance.push_back(clearance[i] + row.beyond);
    part.pressure.push_back(pressure[i]);
    part.gap.push_back(row.gap + row.beyond);
    part.weight.push_back(row.weight);
    part.open.push_back(part.clearance.back() > 0);
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
LocalVector trace_of(const Discretization& discrete, const Solution& solution, int t,
                     const ElementMatrices& matrices) {
  LocalVector term = matrices.compliance * solution.stress.col(t) +
                     discrete.spaces().divergence.transpose() * solution.displacement.col(t);
  for (int z = 0; z < matrices.skew.rows(); ++z)
    term += solution.rotation[discrete.mesh.triangles[t][z]] * matrices.skew.row(z).transpose();
  return term.head(discrete.traces.traces_per_triangle());
}

/// <t,u> on one boundary edge.
double work_of_traction(const Discretization& discrete, const Solution& solution, int edge) {
  const int t = discrete.mesh.edge_triangles[edge][0], n = discrete.spaces().traces_per_edge();
  const int first = discrete.mesh.local_edge(t, edge) * n;
  const LocalVector trace = trace_of(discrete, solution, t, discrete.element.matrices(discrete.mesh, t));
  double sum = 0;
  for (int j = first; j < first + n; ++j) {
    const int dof = discrete.traces.dof(t, j);
    if (discrete.traces.is_free(dof)) sum += discrete.coupling_load[discrete.traces[dof].unknown] * trace[j];
  }
  return sum;
}

/// ½(Cσ,σ) − (f,u) − <t,u>, where u turns with the rotation if the spaces leave it the couples.
double energy(const Discretization& discrete, const Solution& solution) {
  double sum = 0;
  PerShape<LocalMatrix> compliances(discrete);
  for (int t = 0; t < discrete.triangles(); ++t) {
    const LocalMatrix& compliance =
        compliances(t, [](const ElementMatrices& matrices) { return matrices.compliance; });
    const LocalVector sigma = solution.stress.col(t);
    sum += 0.5 * sigma.dot(compliance.lazyProduct(sigma)) -
           discrete.load.col(t).dot(solution.displacement.col(t));
  }
  for (const BoundaryPart& part : discrete.mesh.boundary)
    for (const int edge : part.edges) sum -= work_of_traction(discrete, solution, edge);
  for (int point = 0; point < solution.rotation.size(); ++point)
    sum -= discrete.coupling_load[discrete.traces.rotation_at(point)] * solution.rotation[point];
  return sum;
}

Reaction reaction(const Discretization& discrete, const BoundaryPart& part, const Eigen::MatrixXd& stress) {
  std::vector<double> values;
  for (const FluxFunctional& functional : reactions_on(discrete, part))
    values.push_back(functional(discrete, stress));
  return make_reaction(part.name, values);
}

Unknowns count_unknowns(const Discretization& discrete) {
  const std::int64_t edges = static_cast<std::int64_t>(discrete.mesh.edges.size());
  const std::int64_t triangles = discrete.triangles();
  const Spaces& spaces = discrete.spaces();
  const int inner = spaces.stresses() - discrete.traces.traces_per_triangle();
  return {edges * spaces.traces_per_edge() + triangles * inner, triangles * spaces.displacements(),
          discrete.clearance.unknowns,
          spaces.rotations() ? static_cast<std::int64_t>(discrete.mesh.points.size()) : 0};
}

/// What must be known before the numbers are used, and what would make them better.
std::vector<std::string> warnings(const Problem& problem, const Solution& solution, const ErrorBound& bound) {
  if (bound.relative < 1) return {};
  if (is_at_rest(problem, solution, bound))
    return {"the body has no stress but rounding: a bound relative to it says nothing"};
  const bool converged = solution.summary.outcome == Outcome::converged;
  std::ostringstream relative;
  relative << std::setprecision(3) << bound.relative;
  std::string remedy = "let the iteration converge";
  if (converged)
    remedy =
        "take a finer mesh (mesh.size, mesh.divisions or mesh.refine) or let it refine itself "
        "(mesh.adaptive)";
  if (converged && solution.scheme == Scheme::nonconforming)
    remedy += ", or take the conforming scheme, which follows bending on far fewer triangles";
  return {"the relative error bound is " + relative.str() +
          ": the error may be larger than the stress itself, and this answer is worth nothing; " + remedy};
}

}  // namespace

bool is_at_rest(const Problem& problem, const Solution& solution, const ErrorBound& bound) {
  const double displacement = solution.displacement.lpNorm<Eigen::Infinity>();
  double length = displacement, compliance = std::numeric_limits<double>::infinity();
  for (const ContactPart& part : solution.contact)
    for (const double clearance : part.clearance)
      length = std::max(length, std::min(clearance, kFar * displacement));
  for (int t = 0; t < static_cast<int>(solution.mesh->triangles.size()); ++t) {
    const auto c = compliance_at(problem.material, solution.mesh->centroid(t));
    compliance = std::min(compliance, c.diagonal().minCoeff());
  }
  constexpr double rounding = 1e-11;
  const double might_be = length / std::sqrt(compliance);
  return bound.value <= bound.relative * rounding * might_be &&
         bound.value <= std::sqrt(2 * rounding) * might_be;
}

Timings timings(const Progress& progress) {
  return {progress.seconds_in(Phase::mesh),      progress.seconds_in(Phase::assemble),
          progress.seconds_in(Phase::factorize), progress.seconds_in(Phase::iterate),
          progress.seconds_in(Phase::certify),   progress.seconds()};
}

Solution describe(const Discretization& discrete, std::shared_ptr<const Mesh> mesh, Fields& fields,
                  const Settings& settings, Progress& progress) {
  Solution solution;
  Summary& summary = solution.summary;
  solution.scheme = discrete.problem.scheme;
  solution.mesh = std::move(mesh);
  solution.components = discrete.spaces().components;
  solution.stress = std::move(fields.stress);
  solution.displacement = std::move(fields.displacement);
  solution.rotation = discrete.traces.rotation(fields.coupling);
  progress.check();
  summary.energy = energy(discrete, solution);
  solution.stress_at_centroids = stress_at_centroids(discrete.mesh, discrete.spaces(), solution.stress);
  solution.displacement_at_points = displacement_at_points(discrete.problem, solution);
  solution.out_of_plane_stress =
      out_of_plane_stress(discrete.problem.material, discrete.mesh, solution.stress_at_centroids);
  for (const BoundaryPart& part : discrete.mesh.boundary)
    summary.parts.push_back(reaction(discrete, part, solution.stress));
  const Eigen::VectorXd clearance = discrete.clearance.clearance(fields.clearance);
  const Eigen::VectorXd pressure = contact_pressure(discrete, solution.stress);
  solution.contact = contact_parts(discrete.clearance, discrete.mesh, clearance, pressure);

  progress.check();
  summary.residuals = residuals(solution, clearance, pressure, discrete, progress);
  summary.outcome = judged(fields.outcome, summary.residuals, settings);
  summary.iterations = progress.iterations();
  summary.advice = advice(settings, summary.outcome, summary.iterations);
  summary.method = std::holds_alternative<ActiveSet>(settings.method) ? "active_set" : "uzawa";
  summary.notes = discrete.mesh.notes;
  std::ranges::move(notes_on_curves(discrete, clearance), std::back_inserter(summary.notes));
  std::ranges::move(notes_on_strains(solution), std::back_inserter(summary.notes));
  summary.triangles = discrete.triangles();
  summary.unknowns = count_unknowns(discrete);
  summary.contact = sum_up(solution.contact);
  summary.timings = timings(progress);
  solution.history = progress.take_history();
  if (!is_in_range(solution)) throw Overflow();
  return solution;
}

namespace {

/// A solution that converged has not all that was asked for.
void end_late(Summary& summary, const std::string& why) {
  if (summary.outcome != Outcome::converged) return;
  summary.outcome = Outcome::time_limit;
  summary.advice = why;
}

void add(const Problem& problem, Certificate certificate, Solution& solution) {
  Summary& summary = solution.summary;
  if (certificate.has_bound()) {
    std::ranges::copy(warnings(problem, solution, certificate.bound), std::back_inserter(summary.notes));
    summary.error_bound = std::move(certificate.bound);
    summary.quantities = std::move(certificate.quantities);
    solution.error_squares = std::move(certificate.squares);
    solution.admissible_pressure = std::move(certificate.pressure);
    if (!certificate.late.empty()) end_late(summary, certificate.late);
  } else {
    std::string why;
    for (const std::string& reason : certificate.bound.unmet) why += (why.empty() ? "" : "; ") + reason;
    if (why.empty()) why = "its numbers leave the range of double precision";
    summary.notes.push_back("there is no error bound: " + why);
  }
}

}  // namespace

void add_bound(const Problem& problem, const std::function<Certificate()>& certify, Solution& solution,
               Progress& progress) {
  try {
    progress.enter(Phase::certify);
    add(problem, certify(), solution);
  } catch (const TimeUp&) {
    const std::string why =
        "the time limit was reached before the error bound was known: raise solver.time_limit or coarsen the "
        "mesh";
    solution.summary.notes.push_back("there is no error bound: " + why);
    end_late(solution.summary, why);
  }
  solution.summary.timings = timings(progress);
}

}  // namespace signorini
