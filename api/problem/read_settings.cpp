#include "api/limits.hpp"
#include "api/problem/problem_members.hpp"

namespace signorini::api {
namespace {

/// A parameter of the Uzawa iteration as the document has it.
struct Parameter {
  bool sound = true;             ///< false: a fault was added
  std::optional<double> number;  ///< none: `auto`
};

Parameter read_parameter(const std::optional<Value>& value, std::string_view expected, double least,
                         bool least_allowed) {
  if (!value || value->json() == "auto") return {};
  const auto number =
      value->number(expected, [&](double v) { return v > least || (least_allowed && v == least); });
  return {number.has_value(), number};
}

std::optional<double> read_tolerance(const Object& object, bool accelerated) {
  const auto value = object.find("tolerance");
  if (!value) return std::nullopt;
  // The relative residuals of the accelerated form cannot be seen to fall below rounding.
  if (accelerated)
    return value->number("a number from 1e-14 to 1 (1 excluded)",
                         [](double v) { return v >= 1e-14 && v < 1; });
  return value->number("a number between 0 and 1 (both excluded)", [](double v) { return v > 0 && v < 1; });
}

std::optional<int> read_max_iterations(const Object& object) {
  const auto value = object.find("max_iterations");
  return value ? value->integer(1, limits::iterations) : std::nullopt;
}

Method read_paper_form(const Object& object, double rho, double augmentation) {
  PaperUzawa uzawa;
  uzawa.rho = rho;
  uzawa.augmentation = augmentation;
  if (const auto initial = object.find("initial_displacement"))
    uzawa.initial_displacement = initial->number().value_or(uzawa.initial_displacement);
  uzawa.tolerance = read_tolerance(object, false).value_or(uzawa.tolerance);
  uzawa.max_iterations = read_max_iterations(object).value_or(uzawa.max_iterations);
  return uzawa;
}

Method read_accelerated_form(const Object& object) {
  Mprgp uzawa;
  if (const auto initial = object.find("initial_displacement"))
    initial->fault("belongs to the paper's form; give numbers for rho and augmentation, or leave it out");
  uzawa.tolerance = read_tolerance(object, true).value_or(uzawa.tolerance);
  uzawa.max_iterations = read_max_iterations(object).value_or(uzawa.max_iterations);
  return uzawa;
}

/// Of two parameters one is a number and one is not: whichever form is meant, the rest is read only to
/// find its faults.
Method contradictory(const Object& object, const Value& solver, const char* is_auto, const char* is_number) {
  const auto given = object.find(is_auto);
  const std::string pointer = given ? given->pointer() : solver.pointer() + '/' + is_auto;
  solver.faults().add(pointer, "must be a number, for " + std::string(is_number) +
                                   " is one (the paper's form); or make both \"auto\"");
  return read_paper_form(object, 0, 0);
}

Method read_uzawa(const Object& object, const Value& solver) {
  object.allow(
      {"method", "rho", "augmentation", "initial_displacement", "tolerance", "max_iterations", "time_limit"},
      "the solver uzawa");
  const auto rho = read_parameter(object.find("rho"), "a positive number or \"auto\"", 0, false);
  const auto augmentation =
      read_parameter(object.find("augmentation"), "a number that is not negative, or \"auto\"", 0, true);
  if (!rho.sound || !augmentation.sound) return read_paper_form(object, 0, 0);
  if (rho.number && augmentation.number) return read_paper_form(object, *rho.number, *augmentation.number);
  if (rho.number) return contradictory(object, solver, "augmentation", "rho");
  if (augmentation.number) return contradictory(object, solver, "rho", "augmentation");
  return read_accelerated_form(object);
}

Method read_active_set(const Object& object) {
  object.allow({"method", "max_iterations", "time_limit"}, "the solver active_set");
  ActiveSet active_set;
  active_set.max_iterations = read_max_iterations(object).value_or(active_set.max_iterations);
  return active_set;
}

}  // namespace

Settings read_settings(const Value& value) {
  Settings settings;
  const auto object = value.object();
  if (!object) return settings;

  std::optional<MethodName> method = MethodName::uzawa;
  if (const auto member = object->find("method")) method = member->one_of(method_names);
  if (method)
    settings.method =
        *method == MethodName::active_set ? read_active_set(*object) : read_uzawa(*object, value);
  if (const auto limit = object->find("time_limit")) settings.time_limit = limit->positive();
  return settings;
}

}  // namespace signorini::api
