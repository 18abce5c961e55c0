#include "api/result/result_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace signorini::api {
namespace {

std::string shown(double number, int count = 6) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.*g", count, number);
  return text.data();
}

std::string percent(double part) {
  return shown(100 * part, 3) + " %";
}

std::string counted(std::int64_t count, const std::string& what) {
  return std::to_string(count) + ' ' + what + (count == 1 ? "" : "s");
}

/// A text of the client on one line: what a terminal would take for a command is left out.
std::string plain(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    line += byte < 0x20 || byte == 0x7f ? ' ' : c;
  }
  return line;
}

using Row = std::vector<std::string>;

/// The rows with their columns beneath each other, the first one to the left and the others to the right.
void put_table(PieceWriter& out, const std::vector<Row>& rows) {
  std::vector<std::size_t> widths(rows.front().size());
  for (const Row& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  for (const Row& row : rows) {
    std::string line = row[0] + std::string(widths[0] - row[0].size(), ' ');
    for (std::size_t i = 1; i < row.size(); ++i)
      line += "  " + std::string(widths[i] - row[i].size(), ' ') + row[i];
    out.put(line.substr(0, line.find_last_not_of(' ') + 1) + '\n');
  }
}

void put_line(PieceWriter& out, const std::string& name, const std::string& what) {
  constexpr std::size_t width = 13;
  out.put(name + std::string(width - std::min(width, name.size()), ' ') + what + '\n');
}

void put_bound(PieceWriter& out, const ErrorBound& bound) {
  put_line(out, "error bound",
           shown(bound.value) + ", " + percent(bound.relative) + " of the stress, " +
               (bound.guaranteed ? "guaranteed" : "not guaranteed"));
  for (const std::string& reason : bound.unmet) put_line(out, "", reason);
  put_line(out, "",
           "energy between " + shown(bound.energy_lower, 9) + " and " + shown(bound.energy_upper, 9));
}

void put_reactions(PieceWriter& out, const std::vector<Reaction>& parts) {
  if (parts.empty()) return;
  const std::size_t components = parts.front().force.size();
  std::vector<Row> rows{components == 1 ? Row{"part", "force", "moment"}
                                        : Row{"part", "force x", "force y", "moment"}};
  for (const Reaction& reaction : parts) {
    Row row{plain(reaction.part)};
    for (const double force : reaction.force) row.push_back(shown(force));
    row.push_back(shown(reaction.moment));
    row.resize(rows.front().size());
    rows.push_back(std::move(row));
  }
  out.put("\n");
  put_table(out, rows);
}

/// As many digits as tell the ends of the interval apart, and one more.
std::string shown_between(double number, double width) {
  const double digits = width > 0 ? std::ceil(std::log10(std::abs(number) / width)) + 2 : 12;
  return shown(number, static_cast<int>(std::clamp(digits, 3., 15.)));
}

void put_quantities(PieceWriter& out, const std::vector<EnclosedQuantity>& quantities) {
  if (quantities.empty()) return;
  std::vector<Row> rows{{"quantity", "estimate", "lower", "upper", ""}};
  for (const EnclosedQuantity& own : quantities) {
    const double width = own.upper - own.lower;
    Row row{plain(own.name), own.is_bounded() ? shown_between(own.estimate, width) : shown(own.estimate)};
    for (const double end : {own.lower, own.upper})
      row.push_back(own.is_bounded() ? shown_between(end, width) : "");
    row.push_back(own.guaranteed ? "guaranteed" : "not guaranteed");
    rows.push_back(std::move(row));
  }
  out.put("\n");
  put_table(out, rows);
  for (const EnclosedQuantity& own : quantities)
    for (const std::string& reason : own.unmet) put_line(out, plain(own.name), plain(reason));
}

/// Of what supports take, the numbers of which something is known.
void put_certified(PieceWriter& out, const Certified& certified) {
  std::vector<Row> rows{{"certified", "estimate", "lower", "upper"}};
  const auto add = [&](const std::string& name, const EnclosedNumber& number) {
    if (!number.has_lower() && !number.has_upper()) return;
    const double width = number.upper - number.lower;
    const auto digits = [&](double own) {
      return !std::isfinite(own) ? "" : number.is_bounded() ? shown_between(own, width) : shown(own);
    };
    rows.push_back({name, digits(number.estimate), digits(number.lower), digits(number.upper)});
  };
  add("work of the loads", certified.work);
  for (const CertifiedSupport& support : certified.supports) {
    std::string of;
    for (const std::string& part : support.parts) of += (of.empty() ? "" : " and ") + plain(part);
    for (std::size_t c = 0; c < support.force.size(); ++c)
      add(of + (support.force.size() == 1 ? ", force"
                : c == 0                  ? ", force x"
                                          : ", force y"),
          support.force[c]);
    if (support.moment) add(of + ", moment", *support.moment);
    if (support.pressure_force) add(of + ", pressure force", *support.pressure_force);
  }
  out.put("\n");
  put_table(out, rows);
}

void put_levels(PieceWriter& out, const std::vector<Level>& levels) {
  if (levels.empty()) return;
  std::vector<Row> rows{{"level", "triangles", "unknowns", "bound", "relative", "seconds"}};
  for (const Level& level : levels)
    rows.push_back({std::to_string(level.number), std::to_string(level.triangles),
                    std::to_string(level.unknowns), shown(level.bound, 4), percent(level.relative),
                    shown(level.seconds, 3)});
  out.put("\n");
  put_table(out, rows);
}

void put_sweep(PieceWriter& out, const std::vector<SweepEntry>& sweep) {
  if (sweep.empty()) return;
  std::vector<Row> rows{{"entry", "energy", "bound", "force", "pressure", "length", "seconds", ""}};
  for (std::size_t i = 0; i < sweep.size(); ++i) {
    const SweepEntry& entry = sweep[i];
    const std::string name = std::to_string(i) + (entry.title.empty() ? "" : " " + plain(entry.title));
    if (!entry.error.empty()) {
      rows.push_back({name, "", "", "", "", "", shown(entry.seconds, 3), plain(entry.error)});
      continue;
    }
    rows.push_back({name, shown(entry.energy), entry.error_bound ? percent(entry.error_bound->relative) : "",
                    shown(entry.sums.force), shown(entry.sums.max_pressure), shown(entry.sums.length),
                    shown(entry.seconds, 3), plain(entry.advice)});
  }
  out.put("\n");
  put_table(out, rows);
}

void put_summary(PieceWriter& out, std::string_view title, const Summary& summary) {
  if (!title.empty()) out.put(plain(title) + "\n\n");
  put_line(out, name(summary.outcome),
           counted(summary.iterations, "iteration") + " of " + summary.method + ", " +
               counted(summary.triangles, "triangle") + ", " +
               counted(summary.unknowns.stress, "stress unknown") + ", " + shown(summary.timings.total, 3) +
               " s");
  if (!summary.advice.empty()) put_line(out, "", plain(summary.advice));
  put_line(out, "energy", shown(summary.energy, 9));
  if (summary.error_bound) put_bound(out, *summary.error_bound);
  put_line(out, "contact",
           "force " + shown(summary.contact.force) + ", largest pressure " +
               shown(summary.contact.max_pressure) + ", closed length " + shown(summary.contact.length));
  for (const std::string& note : summary.notes) put_line(out, "note", plain(note));
}

}  // namespace

bool write_result_table(std::string_view title, const Solution& solution, const Sink& sink) {
  return write_all(sink, [&](PieceWriter& out) {
    put_summary(out, title, solution.summary);
    put_reactions(out, solution.summary.parts);
    put_quantities(out, solution.summary.quantities);
    if (solution.summary.certified) put_certified(out, *solution.summary.certified);
    put_levels(out, solution.summary.levels);
    put_sweep(out, solution.sweep);
  });
}

}  // namespace signorini::api
