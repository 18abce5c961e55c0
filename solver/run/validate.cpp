#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include <Eigen/Geometry>

#include "data_check.hpp"
#include "fem/clearance_space.hpp"
#include "fem/contact_direction.hpp"
#include "fem/element.hpp"
#include "fem/quadrature.hpp"
#include "fem/triangle_pieces.hpp"
#include "mesh/domain_mesh.hpp"
#include "problem/fields.hpp"
#include "progress/progress.hpp"
#include "run/region.hpp"
#include "solve.hpp"

namespace signorini {
namespace {

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// Steps that may be taken, see steps_of().
constexpr double kAll = std::numeric_limits<double>::infinity(), kOnCoarseMesh = 5e5;

/// What encloses its values everywhere tells so, in one look.
bool is_known_to_be_finite(const Field& field, const Mesh& mesh) {
  if (field.formula() == nullptr) return false;
  Eigen::AlignedBox2d box;
  for (const Point& point : mesh.points) box.extend(point);
  bool undecided = false;
  return is_known(range(series_on_triangle(*field.formula(), triangle_around(box), 0, undecided)));
}

/// Collects the faults of a problem, subject by subject.
class Validation {
 public:
  /// `most_steps`: for all fields together, each of which has its share. Where its formula is long and places
  /// many, only each so many is asked.
  Validation(const Problem& problem, double most_steps, Progress* progress = nullptr)
      : problem_(problem), most_steps_(most_steps), progress_(progress) {
    double formulas = 1;  // the gaps are asked twice
    const auto count = [&](const std::vector<const Field*>& fields) {
      if (!std::ranges::all_of(fields, &Field::is_constant)) ++formulas;
    };
    count(fields_of(problem.material));
    for (const Field& component : problem.body.fields()) count({&component});
    for (const auto& [part, condition] : problem.boundary) count(fields_of(condition));
    share_ = most_steps / formulas;
  }

  std::vector<Fault> run() {
    faults_ = validate(problem_.domain, problem_.mesh);
    if (!faults_.empty()) return std::move(faults_);
    check_boundary();
    const int d = components(problem_.material);
    if (problem_.body.size() != 0 && problem_.body.size() != d)
      fault("/load/body",
            d == 1 ? "must be one number for a membrane" : "must be a pair for an elastic body");
    if (!faults_.empty()) return std::move(faults_);
    if (const std::optional<Mesh> mesh = make_coarse_mesh(problem_.domain)) check_fields(*mesh);
    return std::move(faults_);
  }

  /// All that the discrete problem asks on its mesh.
  std::vector<Fault> run_on(const Mesh& mesh) {
    check_fields(mesh);
    return std::move(faults_);
  }

  std::vector<Fault> run_on_data(const Mesh& mesh, bool gaps_only, bool other_material) {
    if (other_material) check_material(mesh);
    if (!gaps_only) check_body(mesh);
    check_boundary_data(mesh);
    if (faults_.empty()) check_gaps(mesh);
    return std::move(faults_);
  }

  /// What it has taken so far.
  double steps() const { return steps_; }
  /// All places were asked.
  bool is_complete() const { return is_complete_; }

 private:
  void fault(std::string where, std::string detail) {
    faults_.push_back({std::move(where), std::move(detail)});
  }

  void check_boundary() {
    const std::vector<std::string> parts = part_names(problem_.domain);
    const std::set<std::string_view> known(parts.begin(), parts.end());
    bool held = false;
    for (const auto& [part, condition] : problem_.boundary) {
      if (!known.contains(part))
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

  /// Evaluates every field where the mesh needs it.
  void check_fields(const Mesh& mesh) {
    check_material(mesh);
    check_body(mesh);
    check_boundary_data(mesh);
    if (faults_.empty()) check_gaps(mesh);
  }

  void check_material(const Mesh& mesh) {
    attempt([&] {
      sample(mesh, fields_of(problem_.material),
             [&](const Point& x) { compliance_at(problem_.material, x); });
    });
  }

  void check_body(const Mesh& mesh) {
    for (const Field& component : problem_.body.fields())
      if (!is_known_to_be_finite(component, mesh))
        attempt([&] { sample(mesh, {&component}, [&](const Point& x) { component(x); }); });
  }

  void check_boundary_data(const Mesh& mesh) {
    for (const BoundaryPart& part : mesh.boundary) {
      const auto condition = problem_.boundary.find(part.name);
      if (condition != problem_.boundary.end())
        attempt([&] { check_condition(mesh, part, condition->second); });
    }
  }

  /// Of a gap that the ends of edges do not need they are not asked.
  void check_condition(const Mesh& mesh, const BoundaryPart& part, const Condition& condition) {
    if (!may_take(0)) return;
    const bool with_ends =
        std::holds_alternative<Fixed>(condition) ||
        (std::holds_alternative<Contact>(condition) && problem_.scheme == Scheme::conforming);
    const std::vector<const Field*> fields = fields_of(condition);
    const auto* contact = std::get_if<Contact>(&condition);
    const std::size_t stride = stride_for(part.edges.size() * EdgeRule::size, fields);
    for (std::size_t i = 0; i < part.edges.size(); i += stride) {
      const int edge = part.edges[i];
      if (contact) contact_direction(mesh, part, *contact, edge);
      const auto evaluate = [&](double s) {
        const auto [x, normal] = mesh.on_boundary(edge, s);
        for (const Field* field : fields) (*field)(x, normal);
      };
      steps_ += steps_of(fields) * EdgeRule::size;
      std::ranges::for_each(edge_rule().points, evaluate);
      if (with_ends) evaluate(0), evaluate(1);
    }
  }

  /// In all places or none.
  void check_gaps(const Mesh& mesh) {
    const double steps = steps_on_boundary(problem_, mesh);
    if (!may_take(steps)) return;
    steps_ += steps;
    attempt([&] { make_clearance_space(problem_, mesh); });
  }

  /// Besides those that were taken.
  bool may_take(double steps) {
    const bool may = steps_ + steps <= most_steps_;
    is_complete_ = is_complete_ && may;
    return may;
  }

  template <typename Evaluate>
  void attempt(const Evaluate& evaluate) {
    if (progress_) progress_->check();
    try {
      evaluate();
    } catch (const InvalidProblem& invalid) {
      faults_.insert(faults_.end(), invalid.faults().begin(), invalid.faults().end());
    }
  }

  std::size_t stride_for(std::size_t places, const std::vector<const Field*>& fields) {
    const auto stride = 1 + static_cast<std::size_t>(static_cast<double>(places) * steps_of(fields) / share_);
    is_complete_ = is_complete_ && stride == 1;
    return stride;
  }

  template <typename Evaluate>
  void sample(const Mesh& mesh, const std::vector<const Field*>& fields, const Evaluate& evaluate) {
    if (std::ranges::all_of(fields, &Field::is_constant)) {
      evaluate(mesh.centroid(0));
      return;
    }
    const std::size_t stride = stride_for(mesh.triangles.size() * TriangleRule::size, fields);
    for (std::size_t t = 0, asked = 0; t < mesh.triangles.size(); t += stride, ++asked) {
      if (progress_ && asked % 64 == 0) progress_->check();
      const AffineMap map(mesh.corners(static_cast<int>(t)));
      for (const Point& reference : triangle_rule().points) evaluate(map(reference));
      evaluate(mesh.centroid(static_cast<int>(t)));
      steps_ += steps_of(fields) * TriangleRule::size;
    }
  }

  const Problem& problem_;
  const double most_steps_;
  double share_;  ///< of a field
  Progress* const progress_;
  std::vector<Fault> faults_;
  double steps_ = 0;
  bool is_complete_ = true;
};

}  // namespace

double steps_on_boundary(const Problem& problem, const Mesh& mesh) {
  double steps = 0;
  for (const BoundaryPart& part : mesh.boundary) {
    const auto condition = problem.boundary.find(part.name);
    if (condition != problem.boundary.end())
      steps +=
          static_cast<double>(part.edges.size() * EdgeRule::size) * steps_of(fields_of(condition->second));
  }
  return steps;
}

void apply(const Variation& variation, const Problem& original, Problem& varied) {
  varied.body = variation.body;
  varied.boundary = original.boundary;
  for (const auto& [part, condition] : variation.boundary) varied.boundary.insert_or_assign(part, condition);
  varied.load_key = variation.load_key;
  varied.material = variation.material ? *variation.material : original.material;
}

namespace {

void check_simple(const Problem& problem, std::vector<Fault>& faults) {
  for (const Quantity& quantity : problem.quantities)
    if (quantity.outline && !is_simple(*quantity.outline))
      faults.push_back(
          {quantity.outline->name, "has sides that cross each other: give its corners one after the other"});
}

}  // namespace

std::vector<Fault> validate(const Problem& problem) {
  std::vector<Fault> faults = Validation(problem, kOnCoarseMesh).run();
  check_simple(problem, faults);
  return faults;
}

std::vector<Fault> validate(const Problem& problem, const Settings& settings) {
  std::vector<Fault> faults = validate(problem);
  if (problem.mesh.adaptive && std::holds_alternative<PaperUzawa>(settings.method))
    faults.push_back({"/mesh/adaptive", paper_form_needs_one_mesh});
  return faults;
}

std::vector<Fault> validate(const Problem& problem, const std::vector<Variation>& sweep) {
  return faults_of_sweep(problem, sweep, kAll, nullptr);
}

namespace {

/// Adds the faults of the variations until so many steps are taken; then they are not complete.
void check_sweep(const Problem& problem, const std::vector<Variation>& sweep, const Mesh& mesh,
                 double most_of_field, double most_steps, Progress* progress, DataCheck& check) {
  Problem varied = problem;
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    check.is_complete = check.is_complete && most_steps > 0;
    if (most_steps <= 0) return;
    apply(sweep[i], problem, varied);
    Validation validation(varied, most_of_field, progress);
    const bool other_gaps_only = !problem.load_key.empty() && varied.load_key == problem.load_key;
    const std::string place = "/sweep/" + std::to_string(i);
    for (Fault& fault : validation.run_on_data(mesh, other_gaps_only, sweep[i].material != nullptr)) {
      if (!fault.where.starts_with(place)) fault.where = place + fault.where;
      check.faults.push_back(std::move(fault));
    }
    check.is_complete = check.is_complete && validation.is_complete();
    most_steps -= validation.steps();
  }
}

}  // namespace

std::vector<Fault> faults_of_sweep(const Problem& problem, const std::vector<Variation>& sweep,
                                   double most_steps, Progress* progress) {
  if (sweep.empty()) return {};
  if (problem.mesh.adaptive)
    return {{"/sweep",
             "an adaptive mesh depends on the loads and gaps, and a sweep has one mesh for all: leave "
             "mesh.adaptive out, or solve the entries one by one"}};
  DataCheck check;
  if (const std::optional<Mesh> mesh = make_coarse_mesh(problem.domain))
    check_sweep(problem, sweep, *mesh, kOnCoarseMesh, most_steps, progress, check);
  return std::move(check.faults);
}

namespace {

void check_outlines(const Problem& problem, const Region& body, std::vector<Fault>& faults) {
  for (const Quantity& quantity : problem.quantities) {
    if (quantity.outline && !body.contains(*quantity.outline))
      faults.push_back(
          {quantity.outline->name, "must lie in the body: the mean is one over the whole polygon"});
  }
}

void check_discs(const Problem& problem, const Region& body, std::vector<Fault>& faults) {
  for (const Quantity& quantity : problem.quantities) {
    if (!quantity.disc) continue;
    const auto& [name, disc] = std::tie(quantity.disc->name, *quantity.disc);
    if (!body.contains(disc))
      faults.push_back({name, "must lie in the body: the mean is one over the whole disc"});
    else if (!body.can_be_seen(disc))
      faults.push_back({name,
                        "must have a radius of at least a millionth of the body's size and coordinates: "
                        "of a smaller one nothing is guaranteed"});
  }
}

}  // namespace

DataCheck check_data(const Problem& problem, const std::vector<Variation>& sweep, const Mesh& mesh,
                     double most_steps, Progress* progress) {
  Validation validation(problem, most_steps, progress);
  DataCheck check{validation.run_on(mesh), validation.is_complete()};
  if (!problem.quantities.empty()) {
    const Region body(mesh);
    check_discs(problem, body, check.faults);
    check_outlines(problem, body, check.faults);
  }
  check_sweep(problem, sweep, mesh, most_steps, most_steps, progress, check);
  return check;
}

void require_sound_data(const Problem& problem, const Mesh& mesh, Progress& progress) {
  if (DataCheck check = check_data(problem, {}, mesh, kAll, &progress); !check.faults.empty())
    throw InvalidProblem(std::move(check.faults));
}

}  // namespace signorini
