#include <algorithm>
#include <cmath>

#include "fem/clearance_space.hpp"
#include "fem/element.hpp"
#include "fem/trace_space.hpp"
#include "mesh/domain_mesh.hpp"
#include "problem/problem.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Collects the faults of a problem, subject by subject.
class Validation {
 public:
  explicit Validation(const Problem& problem) : problem_(problem) {}

  std::vector<Fault> run() {
    faults_ = validate(problem_.domain, problem_.mesh);
    if (!faults_.empty()) return std::move(faults_);
    check_boundary();
    const int d = components(problem_.material);
    if (problem_.body.size() != 0 && problem_.body.size() != d)
      fault("/load/body",
            d == 1 ? "must be one number for a membrane" : "must be a pair for an elastic body");
    if (faults_.empty()) check_fields(make_coarse_mesh(problem_.domain));
    return std::move(faults_);
  }

  std::vector<Fault> run_on_data(const Mesh& mesh, bool gaps_only) {
    if (!gaps_only) check_data(mesh);
    if (faults_.empty()) check_gaps(mesh);
    return std::move(faults_);
  }

 private:
  void fault(std::string where, std::string detail) {
    faults_.push_back({std::move(where), std::move(detail)});
  }

  void check_boundary() {
    const std::vector<std::string> parts = part_names(problem_.domain);
    bool held = false;
    for (const auto& [part, condition] : problem_.boundary) {
      if (std::ranges::find(parts, part) == parts.end())
        fault("/boundary/" + part, "the domain has no part of this name; it has " + listed(parts));
      held = held || std::holds_alternative<Fixed>(condition) || std::holds_alternative<Contact>(condition) ||
             std::holds_alternative<Roller>(condition);
      check_components(part, condition);
    }
    if (!held)
      fault("/boundary",
            "nothing holds the body: make at least one part fixed, or contact with a load that "
            "presses the body on it");
  }

  void check_components(const std::string& part, const Condition& condition) {
    const int d = components(problem_.material);
    const std::string where = "/boundary/" + part;
    const auto* fixed = std::get_if<Fixed>(&condition);
    const auto* traction = std::get_if<Traction>(&condition);
    const VectorField* value = fixed ? &fixed->value : traction ? &traction->value : nullptr;
    if (value && value->size() != 0 && value->size() != d)
      fault(where + "/value",
            d == 1 ? "must be one number for a membrane" : "must be a pair for an elastic body");
    const auto* contact = std::get_if<Contact>(&condition);
    if (contact && d == 1 && !contact->direction.isZero(0))
      fault(where + "/direction", "is for elasticity: a membrane touches across its plane");
    const bool elastic_only =
        std::holds_alternative<Roller>(condition) || std::holds_alternative<Pressure>(condition);
    if (elastic_only && d == 1) fault(where, "rollers and pressures are for elasticity");
  }

  /// Evaluates every field where a coarse mesh of the domain needs it; the solve does the same on the real
  /// mesh.
  void check_fields(const Mesh& mesh) {
    attempt([&] { sample(mesh, [&](const Point& x) { compliance_at(problem_.material, x); }); });
    check_data(mesh);
    if (faults_.empty()) check_gaps(mesh);
  }

  void check_data(const Mesh& mesh) {
    for (int c = 0; c < problem_.body.size(); ++c)
      attempt([&] { sample(mesh, [&](const Point& x) { problem_.body(c, x); }); });
    for (const auto& [part, condition] : problem_.boundary) {
      Problem alone = problem_;
      alone.boundary = {{part, condition}};
      attempt([&] { TraceSpace(alone, mesh, make_clearance_space(alone, mesh)); });
    }
  }

  void check_gaps(const Mesh& mesh) {
    attempt([&] { make_clearance_space(problem_, mesh); });
  }

  template <typename Evaluate>
  void attempt(const Evaluate& evaluate) {
    try {
      evaluate();
    } catch (const InvalidProblem& invalid) {
      faults_.insert(faults_.end(), invalid.faults().begin(), invalid.faults().end());
    }
  }

  template <typename Evaluate>
  void sample(const Mesh& mesh, const Evaluate& evaluate) {
    for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
      const AffineMap map(mesh.corners(t));
      for (const Point& reference : triangle_rule().points) evaluate(map(reference));
    }
  }

  const Problem& problem_;
  std::vector<Fault> faults_;
};

}  // namespace

void apply(const Variation& variation, Problem& problem) {
  problem.body = variation.body;
  problem.boundary = variation.boundary;
  problem.load_key = variation.load_key;
}

std::vector<Fault> validate(const Problem& problem) {
  return Validation(problem).run();
}

std::vector<Fault> validate(const Problem& problem, const Settings& settings) {
  std::vector<Fault> faults = validate(problem);
  if (problem.mesh.adaptive && std::holds_alternative<PaperUzawa>(settings.method))
    faults.push_back({"/mesh/adaptive", paper_form_needs_one_mesh});
  return faults;
}

std::vector<Fault> validate(const Problem& problem, const std::vector<Variation>& sweep) {
  std::vector<Fault> faults;
  if (sweep.empty()) return faults;
  if (problem.mesh.adaptive)
    return {{"/sweep", "an adaptive mesh depends on the loads and gaps, and a sweep has one mesh for all: leave "
                       "mesh.adaptive out, or solve the entries one by one"}};
  const Mesh mesh = make_coarse_mesh(problem.domain);
  Problem varied = problem;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    apply(sweep[i], varied);
    const bool other_gaps_only = !problem.load_key.empty() && varied.load_key == problem.load_key;
    const std::string place = "/sweep/" + std::to_string(i);
    for (Fault& fault : Validation(varied).run_on_data(mesh, other_gaps_only)) {
      if (!fault.where.starts_with(place)) fault.where = place + fault.where;
      faults.push_back(std::move(fault));
    }
  }
  return faults;
}

}  // namespace signorini
