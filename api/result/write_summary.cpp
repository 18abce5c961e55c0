#include <algorithm>

#include "api/result/result_members.hpp"

namespace signorini::api {

// A writer of a whole struct begins with a structured binding, so that it does not compile while a member is
// missing.

namespace {

void write_residuals(DocumentWriter& out, const Residuals& residuals) {
  const auto& [equilibrium, constitutive, penetration, tension, complementarity, symmetry] = residuals;
  out.begin_object()
      .member("equilibrium", equilibrium)
      .member("constitutive", constitutive)
      .member("penetration", penetration)
      .member("tension", tension)
      .member("complementarity", complementarity)
      .member("symmetry", symmetry)
      .end_object();
}

void write_contact_sums(DocumentWriter& out, const ContactSummary& contact) {
  const auto& [force, max_pressure, length] = contact;
  out.begin_object()
      .member("force", force)
      .member("max_pressure", max_pressure)
      .member("length", length)
      .end_object();
}

void write_reactions(DocumentWriter& out, const std::vector<Reaction>& parts) {
  out.begin_object();
  for (const Reaction& part : parts) {
    out.key(part.part).begin_object();
    if (part.force.size() == 1) {
      out.member("force", part.force[0]);
    } else {
      out.key("force").begin_array().value(part.force[0]).value(part.force[1]).end_array();
      out.member("moment", part.moment);
    }
    out.end_object();
  }
  out.end_object();
}

void write_bound_parts(DocumentWriter& out, const ErrorBound::Parts& parts) {
  const auto& [constitutive, contact, oscillation, equilibration, asymmetry] = parts;
  out.begin_object()
      .member("constitutive", constitutive)
      .member("contact", contact)
      .member("oscillation", oscillation)
      .member("equilibration", equilibration)
      .member("asymmetry", asymmetry)
      .end_object();
}

void write_error_bound(DocumentWriter& out, const ErrorBound& bound) {
  out.begin_object()
      .member("value", bound.value)
      .member("relative", bound.relative)
      .member("guaranteed", bound.guaranteed);
  if (!bound.guaranteed) out.key("unmet").texts(bound.unmet);
  out.member("energy_lower", bound.energy_lower).member("energy_upper", bound.energy_upper);
  write_bound_parts(out.key("parts"), bound.parts);
  out.end_object();
}

void write_enclosed_number(DocumentWriter& out, const EnclosedNumber& number) {
  const auto& [value, estimate, lower, upper] = number;
  out.begin_object().member("value", value).member("estimate", estimate);
  if (number.has_lower()) out.member("lower", lower);
  if (number.has_upper()) out.member("upper", upper);
  out.end_object();
}

void write_stretches(DocumentWriter& out, const std::vector<CertifiedStretch>& stretches) {
  out.begin_array();
  for (const auto& [begin, end, touches, carries_at_most, opens_at_most] : stretches) {
    out.begin_object();
    out.key("begin").begin_array().value(begin.x()).value(begin.y()).end_array();
    out.key("end").begin_array().value(end.x()).value(end.y()).end_array();
    out.member("touches", touches);
    if (carries_at_most) out.member("carries_at_most", *carries_at_most);
    if (opens_at_most) out.member("opens_at_most", *opens_at_most);
    out.end_object();
  }
  out.end_array();
}

void write_enclosed_reaction(DocumentWriter& out, const CertifiedSupport& support) {
  if (support.force.size() == 1) {
    write_enclosed_number(out.key("force"), support.force[0]);
  } else {
    out.key("force").begin_array();
    for (const EnclosedNumber& force : support.force) write_enclosed_number(out, force);
    out.end_array();
  }
  if (support.moment) write_enclosed_number(out.key("moment"), *support.moment);
  if (support.pressure_force) write_enclosed_number(out.key("pressure_force"), *support.pressure_force);
  if (!support.stretches.empty()) write_stretches(out.key("stretches"), support.stretches);
  out.end_object();
}

void write_certified(DocumentWriter& out, const Certified& certified) {
  const auto& [energy, work, supports, unmet] = certified;
  const auto is_sum = [](const CertifiedSupport& support) { return support.parts.size() > 1; };
  out.begin_object();
  write_enclosed_number(out.key("energy"), energy);
  write_enclosed_number(out.key("work"), work);
  out.key("parts").begin_object();
  for (const CertifiedSupport& support : supports)
    if (!is_sum(support)) write_enclosed_reaction(out.key(support.parts[0]).begin_object(), support);
  out.end_object();
  if (std::ranges::any_of(supports, is_sum)) {
    out.key("sums").begin_array();
    for (const CertifiedSupport& support : supports)
      if (is_sum(support))
        write_enclosed_reaction(out.begin_object().key("parts").texts(support.parts), support);
    out.end_array();
  }
  if (!unmet.empty()) out.key("unmet").texts(unmet);
  out.end_object();
}

/// A column each, as in the history.
void write_levels(DocumentWriter& out, const std::vector<Level>& levels) {
  const auto column = [&](std::string_view name, const auto& entry) {
    out.key(name).rows({levels.size()}, [&](std::size_t i) { return entry(levels[i]); });
  };
  out.begin_object();
  column("level", [](const Level& level) { return level.number; });
  column("triangles", [](const Level& level) { return level.triangles; });
  column("unknowns", [](const Level& level) { return level.unknowns; });
  column("bound", [](const Level& level) { return level.bound; });
  column("relative", [](const Level& level) { return level.relative; });
  column("iterations", [](const Level& level) { return level.iterations; });
  column("seconds", [](const Level& level) { return level.seconds; });
  out.end_object();
}

void write_timings(DocumentWriter& out, const Timings& timings) {
  const auto& [mesh, assemble, factorize, iterate, certify, total] = timings;
  out.begin_object()
      .member("mesh", mesh)
      .member("assemble", assemble)
      .member("factorize", factorize)
      .member("iterate", iterate)
      .member("certify", certify)
      .member("total", total)
      .end_object();
}

void write_entry_summary(DocumentWriter& out, const SweepEntry& entry) {
  out.begin_object()
      .member("outcome", name(entry.outcome))
      .member("iterations", entry.iterations)
      .member("energy", entry.energy);
  out.key("residuals")
      .begin_object()
      .member("penetration", entry.penetration)
      .member("tension", entry.tension)
      .member("complementarity", entry.complementarity)
      .end_object();
  write_contact_sums(out.key("contact"), entry.sums);
  write_reactions(out.key("parts"), entry.parts);
  if (entry.error_bound) write_error_bound(out.key("error_bound"), *entry.error_bound);
  if (!entry.quantities.empty()) write_quantities(out.key("quantities"), entry.quantities);
  out.member("seconds", entry.seconds).end_object();
}

}  // namespace

void write_unknowns(DocumentWriter& out, const Unknowns& unknowns) {
  const auto& [stress, displacement, contact, rotation] = unknowns;
  out.begin_object()
      .member("stress", stress)
      .member("displacement", displacement)
      .member("contact", contact)
      .member("rotation", rotation)
      .end_object();
}

void write_quantities(DocumentWriter& out, const std::vector<EnclosedQuantity>& quantities) {
  out.begin_array();
  for (const EnclosedQuantity& quantity : quantities) {
    const auto& [name, value, estimate, lower, upper, guaranteed, unmet, shares] = quantity;
    out.begin_object().member("name", name).member("value", value).member("estimate", estimate);
    if (quantity.is_bounded()) out.member("lower", lower).member("upper", upper);
    out.member("guaranteed", guaranteed);
    if (!guaranteed) out.key("unmet").texts(unmet);
    out.end_object();
  }
  out.end_array();
}

/// All but the quantities, which are a member of the result.
void write_summary(DocumentWriter& out, const Summary& summary) {
  const auto& [outcome, advice, notes, method, iterations, triangles, unknowns, energy, residuals, contact,
               error_bound, parts, quantities, certified, levels, reused, timings, peak_memory_bytes] =
      summary;
  out.begin_object().member("outcome", name(outcome));
  if (!advice.empty()) out.member("advice", advice);
  if (!notes.empty()) out.key("notes").texts(notes);
  out.member("method", method).member("iterations", iterations).member("triangles", triangles);
  write_unknowns(out.key("unknowns"), unknowns);
  out.member("energy", energy);
  write_residuals(out.key("residuals"), residuals);
  write_contact_sums(out.key("contact"), contact);
  write_reactions(out.key("parts"), parts);
  out.member("reused", reused);
  if (error_bound) write_error_bound(out.key("error_bound"), *error_bound);
  if (certified) write_certified(out.key("certified"), *certified);
  if (!levels.empty()) write_levels(out.key("levels"), levels);
  write_timings(out.key("timings"), timings);
  out.member("peak_memory_bytes", peak_memory_bytes).end_object();
}

void write_sweep(DocumentWriter& out, const std::vector<SweepEntry>& sweep, bool with_contact) {
  out.begin_array();
  for (const SweepEntry& entry : sweep) {
    out.begin_object();
    if (!entry.title.empty()) out.member("title", entry.title);
    out.member("status", is_solved(entry) ? "succeeded" : "failed");
    if (!is_solved(entry)) out.member("error", entry.error.empty() ? entry.advice : entry.error);
    if (entry.error.empty()) {
      write_entry_summary(out.key("summary"), entry);
      if (with_contact) write_contact(out.key("contact"), entry.contact);
    }
    out.end_object();
  }
  out.end_array();
}

}  // namespace signorini::api
