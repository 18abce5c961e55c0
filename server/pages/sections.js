// What stands below the picture of a solve, a section each.

import { boundInWords, button, counted, element, percent, seconds, short, table } from "/pages/element.js";
import { clearanceNodes } from "/pages/nodes.js";
import { plot } from "/pages/plot.js";

const numbers = (name, ...tables) => element("details", {}, element("summary", {}, name), tables);
export const section = (id, title, ...content) => element("section", { id, ariaLabel: title }, element("h2", {}, title), content);

// --- the bound

const parts = {
  constitutive: "stress and strain that do not fit each other",
  contact: "pressure where the body does not touch",
  oscillation: "loads that the mesh does not resolve",
  equilibration: "what brings the stress into balance",
  asymmetry: "stress that is not symmetric",
};

const shareOf = (part) => (part > 0 && part < 5e-4 ? "less than 0.1 %" : percent(part));

const reasons = (all) => all.length > 0 && element("ul", {}, all.map((reason) => element("li", {}, reason)));

/// In one sentence, and why it is not proved.
const verdictOf = ({ relative, guaranteed, unmet = [] }) => [
  guaranteed ? element("p", { className: "verdict good" }, `Proved: stress and displacement together are off by at most ${percent(relative)} of the stress, in the energy norm.`)
    : element("p", { className: "verdict open" }, `Estimated: stress and displacement together are off by about ${percent(relative)} of the stress, in the energy norm. It is not proved here.`),
  reasons(unmet)];

export function boundSection({ error_bound: bound, notes = [], advice }) {
  if (!bound) return section("bound", "Error bound", element("p", {}, "Nothing finite is known of the error."), notesOf(notes, advice));
  const { value, energy_lower: lower, energy_upper: upper } = bound;
  const there = Object.entries(bound.parts).filter(([, part]) => part), squares = there.map(([, part]) => part * part), whole = squares.reduce((a, b) => a + b, 0);
  return section("bound", "Error bound", verdictOf(bound),
    element("p", {}, `The energy of the exact solution lies between ${short(lower, 8)} and ${short(upper, 8)}. The bound itself is ${short(value, 6)}; of its square come`),
    element("ul", { className: "shares" }, there.map(([name, part], i) => {
      const bar = element("span", { className: "bar" });
      bar.style.inlineSize = `${(100 * squares[i]) / whole}%`;
      return element("li", {}, element("span", { className: "name" }, `${shareOf(squares[i] / whole)} from ${parts[name] ?? name}`), element("span", { className: "track" }, bar), element("span", { className: "quiet small" }, `${name} ${short(part, 4)}`));
    })), notesOf(notes, advice));
}

const notesOf = (notes, advice) => [advice && element("p", { className: "notice bad" }, advice), notes.map((note) => element("p", { className: "notice" }, note))];

// --- quantities

/// Its value and interval, in so many digits that the ends are told apart.
function told({ value, lower, upper }) {
  const digits = lower < upper ? Math.ceil(Math.log10(Math.max(-lower, upper) / (upper - lower))) + 2 : 6, own = (number) => short(number, Math.min(Math.max(digits, 4), 15));
  return [own(value), lower === undefined ? "–" : upper === undefined ? `≥ ${own(lower)}` : `${own(lower)} … ${own(upper)}`];
}

const quantitiesTable = (caption, quantities) => [
  table(caption, ["name", "value", "interval", "guaranteed"], quantities.map((own) => [own.name, ...told(own), own.guaranteed ? "yes" : "no"])),
  reasons(quantities.flatMap(({ name, unmet = [] }) => unmet.map((reason) => `${name}: ${reason}`)))];

/// `link` leads to their file.
export const quantitiesSection = (quantities, link) => section("quantities", "Quantities", quantitiesTable("What the problem asks for", quantities), element("p", {}, link));

// --- what is guaranteed of every answer whose bound is

const reaction = (of, { force, moment, pressure_force: pressure }) => [
  ...[force].flat().map((own, c, { length }) => [`${of}, force${length > 1 ? ` ${"xy"[c]}` : ""}`, own]), [`${of}, moment`, moment], [`${of}, pressure force`, pressure]];

export function certifiedSection({ energy, work, parts, sums = [], unmet = [] }) {
  const supports = Object.entries(parts), place = (point) => point.map((each) => short(each)).join(", ");
  const numbers = [["energy", energy], ["work of the loads", work], ...supports.flatMap(([name, own]) => reaction(name, own)), ...sums.flatMap((own) => reaction(own.parts.join(" + "), own))];
  const stretches = supports.flatMap(([name, own]) => (own.stretches ?? []).map(({ begin, end, touches, carries_at_most: carries, opens_at_most: opens }) =>
    [name, place(begin), place(end), touches ? "yes" : "–", carries ?? "–", opens ?? "–"]));
  return section("certified", "Guaranteed", table("Each lies in its interval", ["of", "value", "interval"], numbers.filter(([, own]) => own).map(([name, own]) => [name, ...told({ ...own, value: own.estimate })])), reasons(unmet),
    stretches.length > 0 && table("Stretches of contact", ["part", "from", "to", "surely touches", "carries at most", "opens at most"], stretches));
}

// --- the contact

/// Where rows begin and end along their part, and lie: nodes reach half way to their neighbours, edges from end to end.
function extents({ space }, { points: all, boundary }, name, points) {
  const rows = [], half = (list, i, j) => Math.hypot(list[2 * i] - list[2 * j], list[2 * i + 1] - list[2 * j + 1]) / 2;
  const edges = space === "RT0" && clearanceNodes(all, boundary[name], points);
  for (let i = 0, at = 0; 2 * i < points.length; ++i) {
    const own = edges && half(all, ...edges[i]), before = own || (i && half(points, i, i - 1)), behind = own || half(points, i, i + 1) || 0;
    rows.push({ from: at, at: at + before, to: (at += before + behind) });
  }
  return rows;
}

function closedStretches(rows, open) {
  const stretches = [], last = rows.length - 1;
  for (let i = 0; i <= last; ++i) {
    if (open[i]) continue;
    const first = i;
    while (i < last && !open[i + 1]) ++i;
    stretches.push([rows[first].from, rows[i].to]);
  }
  return stretches;
}

function contactStrips(contact, { mesh, stress }) {
  return Object.entries(contact).map(([name, { points, clearance, pressure, gap, open }]) => {
    const extent = extents(stress, mesh, name, points), along = Float64Array.from(extent, ({ at }) => at), stretches = closedStretches(extent, open), dots = along.length < 80;
    const strip = (label, unit, curves) => plot({ label: `${label} along ${name}`, x: { name: "arc length", values: along }, y: { name: unit, zero: true }, curves, stretches, high: 210 });
    const rows = Array.from(along, (s, i) => [s, points[2 * i], points[2 * i + 1], clearance[i], pressure[i], gap[i], open[i] ? "open" : "closed"]);
    return [element("h3", {}, name), element("p", { className: "quiet small" }, stretches.length ? `Closed on ${stretches.map(([from, to]) => `${short(from, 3)} … ${short(to, 3)}`).join(", ")} (shaded).` : "Open everywhere."),
      element("div", { className: "beside wide" }, strip("Pressure", "pressure", [{ name: "pressure", values: pressure, dots }]),
      strip("Clearance and gap", "length", [{ name: "clearance", values: clearance, dots }, { name: "gap", values: gap, broken: true, curve: 1 }])),
      numbers(`Numbers of ${name}`, table(`Contact on ${name}`, ["arc length", "x", "y", "clearance", "pressure", "gap", "state"], rows))];
  });
}

export function contactSection(result, summary) {
  const { contact } = result;
  const { force, max_pressure: most, length } = summary.contact;
  return section("contact", "Contact", Object.keys(contact).length
    ? [element("p", {}, `Force ${short(force, 6)}, largest pressure ${short(most, 6)}, closed on a length of ${short(length, 6)}.`), contactStrips(contact, result)]
    : element("p", {}, "No part of the boundary is a contact."));
}

// --- levels, study, sweep

export function levelsSection({ levels }, view, steps) {
  const body = element("div");
  const show = () => {
    const own = steps.shown() - 1;
    const facts = ["triangle", "unknown", "iteration"].map((name) => counted(levels[`${name}s`][own], name)).join(", ");
    body.replaceChildren(element("p", {}, `Level ${own + 1} of ${steps.count}: ${facts}, bound ${short(levels.bound[own], 4)}, that is ${percent(levels.relative[own])}, after ${seconds(levels.seconds[own])}.`),
      plot({ label: "Relative error bound by triangles", x: { name: "triangles", values: levels.triangles, log: true }, y: { name: "relative bound", log: true }, curves: [{ name: "relative bound", values: levels.relative, dots: true }], marked: own, onPick: (i) => view.set({ level: i + 1 }) }));
  };
  view.onChangeOf("level", show);
  show();
  const names = ["level", "triangles", "unknowns", "bound", "relative", "iterations", "seconds"];
  return section("levels", "Levels of the mesh", body, numbers("Numbers of the levels", table("Levels", names, Array.from(levels.level, (_, i) => names.map((name) => levels[name][i])))));
}

const errors = ["bound", "total_error", "energy_norm_error", "stress_error", "displacement_error", "energy_error"];
const inWords = (name) => name.replaceAll("_", " ");

export function studySection({ rows, rates }) {
  const plots = rates.map((fitted) => {
    const own = rows.filter(({ scheme, error }) => scheme === fitted.scheme && !error);
    const curves = errors.map((key, curve) => ({ name: inWords(key), values: own.map((row) => row[key] ?? NaN), dots: true, curve })).filter(({ values }) => values.some((value) => value > 0));
    const fits = errors.filter((key) => key in fitted).map((key) => `${inWords(key)} ${short(fitted[key], 3)}`);
    return [element("h3", {}, fitted.scheme), plot({ label: `Errors of the ${fitted.scheme} scheme by triangles`, x: { name: "triangles", values: own.map(({ triangles }) => triangles), log: true }, y: { name: "error", log: true }, curves, high: 280 }),
      fits.length ? element("p", {}, `Fitted rates α, as n^(−α/2) in the triangles n: ${fits.join(", ")}.`) : ""];
  });
  const keys = ["scheme", "triangles", ...errors, "seconds"].filter((key) => rows.some((row) => key in row));
  return section("study", "Study", plots, rows.filter(({ error }) => error).map(({ scheme, error }) => element("p", { className: "notice bad" }, `${scheme}: ${error}`)),
    numbers("Numbers of the study", table("Study", keys.map(inWords), rows.map((row) => keys.map((key) => row[key] ?? "–")))));
}

const isObject = (value) => value !== null && typeof value === "object" && !Array.isArray(value);

/// A problem with what one entry of its sweep changes (RFC 7396).
function alone({ sweep, title, ...problem }, own) {
  const patched = (before, patch) => {
    if (!isObject(patch)) return patch;
    const made = Object.assign(Object.create(null), isObject(before) && before);
    for (const [name, value] of Object.entries(patch)) {
      if (value === null) delete made[name];
      else made[name] = patched(made[name], value);
    }
    return made;
  };
  return { ...patched(problem, sweep[own]), title: [title, sweep[own].title || `entry ${own + 1}`].filter(Boolean).join(": ").slice(0, 200) };
}

/// `solve(problem)` poses one.
export function sweepSection(result, view, solve) {
  const { sweep, problem, quantities: asked = [] } = result;
  const body = element("div");
  const name = (entry, i) => entry.title || `entry ${i + 1}`;
  const of = (read) => sweep.map((entry) => (entry.summary ? read(entry.summary) : NaN));
  const choice = element("select", { ariaLabel: "Entry" }, sweep.map((entry, i) => element("option", { value: i + 1 }, `${i + 1}: ${name(entry, i)}`)));
  choice.onchange = () => view.set({ entry: Number(choice.value) });
  const show = () => {
    const own = Math.min(Math.max(view.entry, 1), sweep.length) - 1, entry = sweep[own];
    choice.value = own + 1;
    const again = button("Solve it alone", () => { again.disabled = true; solve(alone(problem, own)); });
    const x = { name: "entry", values: sweep.map((_, i) => i + 1), whole: true }, picked = { marked: own, onPick: (i) => view.set({ entry: i + 1 }), high: 200 };
    const curve = (label, unit, read, band) => plot({ label: `${label} by entry`, x, y: { name: unit, zero: true }, curves: [{ name: label, values: of(read), dots: true, band }], ...picked });
    const bound = entry.summary?.error_bound;
    body.replaceChildren(element("div", { className: "beside wide" },
      curve("contact force", "force", ({ contact }) => contact.force), curve("largest pressure", "pressure", ({ contact }) => contact.max_pressure), curve("closed length", "length", ({ contact }) => contact.length),
      asked.map(({ name: label }, q) => {
        const read = (key) => ({ quantities }) => quantities?.[q]?.[key];
        return curve(label, "value", read("value"), [of(read("lower")), of(read("upper"))]);
      })),
      element("h3", {}, name(entry, own)),
      element("div", {}, bound && verdictOf(bound)),
      element("div", {}, entry.summary?.quantities && quantitiesTable(`Quantities of ${name(entry, own)}`, entry.summary.quantities)),
      element("p", {}, again, element("span", { className: "quiet small" }, bound ? " for its fields" : " for its fields and its bound")),
      entry.error ? element("p", { className: "notice bad" }, entry.error) : "", ...(entry.contact ? contactStrips(entry.contact, result).flat() : []));
  };
  view.onChangeOf("entry", show);
  show();
  const rows = sweep.map((entry, i) => [name(entry, i), entry.status, boundInWords(entry.summary?.error_bound), ...["force", "max_pressure", "length"].map((key) => entry.summary?.contact[key] ?? "–"), entry.summary?.energy ?? "–", entry.summary?.iterations ?? "–", ...asked.flatMap((_, q) => told(entry.summary?.quantities?.[q] ?? {}))]);
  return section("sweep", "Sweep", element("p", {}, element("label", {}, "Entry ", choice)), body, numbers("Numbers of the sweep", table("Sweep", ["entry", "status", "bound", "force", "largest pressure", "closed length", "energy", "iterations", ...asked.flatMap(({ name: label }) => [label, `${label}, interval`])], rows)));
}

// --- figures

export function figuresSection(summary) {
  const { unknowns, timings, residuals, parts: reactions } = summary;
  const pairs = (own) => Object.entries(own).map(([name, value]) => [name.replaceAll("_", " "), value]);
  return section("figures", "Figures", element("div", { className: "beside" },
    table("Unknowns", ["of", "number"], pairs(unknowns)), table("Residuals, relative", ["of", "size"], pairs(residuals)),
    table("Seconds", ["for", "time"], pairs(timings))),
    table("What acts on the body through each part", ["part", "force", "moment"], Object.entries(reactions).map(([name, { force, moment }]) => [name, typeof force === "number" ? force : Array.from(force, (each) => short(each, 6)).join(", "), moment ?? "–"])));
}
