#include "api/picture/picture.hpp"

#include <algorithm>

#include "api/names.hpp"
#include "api/picture/curves.hpp"
#include "api/picture/field_picture.hpp"
#include "api/wording.hpp"

namespace signorini::api {
namespace {

const Names<Picture::Field> field_names{
    {"displacement", Picture::Field::displacement}, {"stress", Picture::Field::stress},
    {"von_mises", Picture::Field::von_mises},       {"error", Picture::Field::error},
    {"contact", Picture::Field::contact},           {"history", Picture::Field::history}};

}  // namespace

Picture::Field Picture::field_named(std::string_view name) {
  if (name.empty()) return Field::displacement;
  const auto entry = std::ranges::find(field_names, name, &Named<Field>::name);
  if (entry != field_names.end()) return entry->value;
  const auto known = only_names(field_names);
  throw InvalidProblem({{"/field", "there is no picture of " + in_quotes(name) + suggestion(name, known) +
                                       "; known are: " + list_of(known)}});
}

std::map<std::string, Contact> Picture::contacts_of(const Problem& problem) {
  std::map<std::string, Contact> contacts;
  for (const auto& [part, condition] : problem.boundary)
    if (const auto* contact = std::get_if<Contact>(&condition)) contacts.emplace(part, *contact);
  return contacts;
}

void Picture::require_available(int components) const {
  const auto refuse = [](const char* where, const std::string& why) { throw InvalidProblem({{where, why}}); };
  if (components == 1 && field == Field::von_mises)
    refuse("/field", "a membrane has no `von_mises`: its stress is a vector; take `stress`");
  if (components == 1 && deformed)
    refuse("/deformed", "a membrane moves out of the plane of the picture; leave it out");
  if (deformed && (field == Field::contact || field == Field::history))
    refuse("/deformed", "curves have no points that could be moved; leave it out");
}

void Picture::require_available(const Solution& solution) const {
  constexpr double farthest = 1e150;
  require_available(solution.components);
  if (field == Field::error && solution.error_squares.size() == 0)
    throw InvalidProblem(
        std::vector<Fault>{{"/field", "the solution has no error bound of which shares could be shown"}});
  if (deformed && !(*deformed * solution.displacement_at_points.cwiseAbs().maxCoeff() < farthest))
    throw InvalidProblem(std::vector<Fault>{
        {"/deformed", "moves the points out of the range of double precision; take a smaller number"}});
}

bool write_picture(const Solution& solution, const Picture& picture, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    switch (picture.field) {
      case Picture::Field::contact:
        return draw_contact(solution.contact, out);
      case Picture::Field::history:
        return draw_history(solution.history, out);
      default:
        return draw_field(solution, picture, out);
    }
  });
}

}  // namespace signorini::api
