// A solve: its picture first, below it what it found out; while it runs its history, row by row.

import { decode } from "/pages/cbor.js";
import { agree, controlsOf } from "/pages/controls.js";
import { asked } from "/pages/dialog.js";
import { button, bytes, counted, element, isOpen, progressInWords, save, seconds, state, tagLinks } from "/pages/element.js";
import { resultOnLevel } from "/pages/fields.js";
import { Figure } from "/pages/figure.js";
import { History } from "/pages/history.js";
import { boundSection, certifiedSection, contactSection, figuresSection, levelsSection, quantitiesSection, studySection, sweepSection } from "/pages/sections.js";
import { ask, follow, getBytes, getJson, isAway, persist, pose } from "/pages/service.js";
import { shell } from "/pages/shell.js";
import { View } from "/pages/view.js";

const main = shell();
const path = location.pathname, view = new View();
const head = element("div", { className: "head" }), picture = element("div", { className: "pictures" }), sections = element("div", { className: "sections" });
const history = new History();
main.append(head, picture, history.whole, sections);

const failed = (error) => picture.replaceChildren(element("p", { className: "notice bad", role: "alert" }, error.message));

// --- the head

function showHead(solve) {
  document.title = `${solve.title || "A solve"} · Signorini`;
  const { summary, error, progress, links } = solve;
  const dismiss = button(isOpen(solve) ? "Cancel" : "Delete", async () => {
    if (!isOpen(solve) && !await asked(["Delete “", element("bdi", {}, solve.title || "without a title"), "” and its result?"], "Delete", "Keep")) return;
    dismiss.disabled = true;
    try {
      await ask(links.self, { method: "DELETE" });
      if (!isOpen(solve)) location.assign("/v1/solves");
    } catch (refusal) {
      failed(refusal);
    }
  });
  const facts = summary ? [counted(summary.triangles, "triangle"), `${counted(summary.iterations, "iteration")}, ${summary.method.replaceAll("_", " ")}`, seconds(summary.timings.total), bytes(summary.peak_memory_bytes)].join(" · ") : progressInWords(progress);
  const files = summary ? [["result", "JSON"], ["vtu", "VTU"], ["picture", "Plain picture"], ["contact_csv", "Contact CSV"], ["history_csv", "History CSV"]].map(([key, name]) => fileLink(links[key], name)) : [];
  head.replaceChildren(element("h1", {}, solve.title || "A solve without a title"),
    element("p", { className: "row" }, state(solve.status), element("span", { className: "quiet" }, facts), solve.tags.length ? element("span", { className: "tags" }, tagLinks(solve.tags)) : ""),
    error ? element("p", { className: "notice bad" }, element("strong", {}, `${error.title}. `), error.detail ?? "", (error.errors ?? []).map((each) => element("span", { className: "line" }, element("code", {}, each.pointer ?? ""), ` ${each.detail}`))) : "",
    element("div", { className: "row" }, dismiss, files));
}

/// A link that shows the token if there is one.
function fileLink(href, name) {
  const link = element("a", { href, className: "small" }, name);
  link.onclick = async (event) => {
    if (!sessionStorage.getItem("token")) return;
    event.preventDefault();
    save(href.split("/").slice(-2).join("-"), await (await ask(href)).blob());
  };
  return link;
}

// --- the result

/// What the picture and the sections show of a solve that has a result.
async function resultOf(solve, onProgress) {
  const { problem } = await getJson(`${solve.links.result}?fields=problem`), body = problem.model === "elasticity";
  const fields = ["mesh", "displacement", "stress", "error_squares", "contact", "quantities", "sweep", "study", ...(body ? ["principal", "von_mises"] : [])];
  return { ...decode(await getBytes(`${solve.links.result}?fields=${fields}`, onProgress)), problem };
}

async function showResult(solve) {
  const said = element("p", { className: "quiet", role: "status" }, "Loading the result …");
  picture.replaceChildren(said);
  const result = await persist(() => resultOf(solve, (count) => { said.textContent = `Loading the result … ${bytes(count)}`; }), (away) => { if (away) said.textContent = isAway; });
  const results = [result], solves = [solve];
  let missing = null;
  if (view.with) try {
    const other = await getJson(`/v1/solves/${encodeURIComponent(view.with)}`);
    results.push(await resultOf(other));
    solves.push(other);
  } catch (error) {
    missing = element("p", { className: "notice bad", role: "alert" }, `The other solve cannot be shown: ${error.message}`);
  }
  const { summary } = solve, steps = summary.levels && stepsOf(summary), isAlone = results.length === 1;
  const [figure] = showPictures(results, solves, isAlone ? steps : null);
  if (missing) picture.prepend(missing);
  if (steps && isAlone) stepThrough(figure, result, steps, solve.links);
  sections.replaceChildren(...[boundSection(summary), summary.certified && certifiedSection(summary.certified), result.quantities && quantitiesSection(result.quantities, fileLink(solve.links.quantities_csv, "Quantities CSV")), contactSection(result, summary), history.whole, summary.levels && levelsSection(summary, view, steps),
    result.study && studySection(result.study), result.sweep && sweepSection(result, view, (problem) => pose(JSON.stringify(problem)).catch(failed)), figuresSection(summary)].filter(Boolean));
}

/// How many levels there are, and which is looked at: at first that of the result.
function stepsOf({ levels, triangles }) {
  const count = levels.level.length, own = levels.triangles.indexOf(triangles) + 1;
  return { count, own, shown: () => Math.min(view.level, count) || own };
}

/// Shows the mesh of the level that is looked at. All come when the first one is asked for.
function stepThrough(figure, result, steps, links) {
  let levels = null;
  const show = async () => {
    try {
      if (steps.shown() !== steps.own) levels ??= getBytes(`${links.result}?fields=levels`).then((all) => decode(all).levels.map((each) => [each.level, resultOnLevel(each)]));
      const all = new Map(await levels);
      figure.show(all.get(steps.shown()) ?? result);
    } catch (error) {
      failed(error);
    }
  };
  view.onChange(show);
  show();
}

function showPictures(results, solves, steps) {
  const figures = results.map((result, i) => new Figure(result, view, solves[i].title || solves[i].id));
  if (figures.length > 1) link(figures);
  picture.replaceChildren(controlsOf(figures, view, solves.map(({ id }) => id), steps),
    element("div", { className: figures.length > 1 ? "two" : "one" }, figures.map((figure, i) => (figures.length > 1 ? element("div", {}, element("h2", {}, i ? element("a", { href: solves[i].links.self }, figure.name) : figure.name), figure.whole) : figure.whole))),
    element("p", { className: "quiet small help" }, figures[0].shape.body ? "Drag to move, " : "Drag to turn, with Shift to move, ", "wheel or two fingers to zoom; with the keyboard arrows, + and −, 0 for the whole, m for the mesh", figures[0].shape.body ? ". The foundation is dashed." : ", f for flat."));
  return figures;
}

/// Two figures have one scale, unless one shows their difference.
function link(figures) {
  const comparable = agree(figures), differ = () => { figures[1].other = comparable && view.difference ? figures[0] : null; };
  view.onChange(differ);
  differ();
  for (const figure of figures) figure.beside = () => {
    if (figures[1].other) return [];
    figures.forEach((each) => each.prepare());
    return figures;
  };
}

// --- as it happens

function tell(name, id, data) {
  if (data.history) history.add(id, data.history);
  if (name !== "progress") return showEnd(data);
  if (current) {
    current.status = "running";
    Object.assign(current.progress, data);
    showHeadSoon();
  }
}

let current = null, waiting = false;
function showHeadSoon() {
  if (waiting) return;
  waiting = true;
  setTimeout(() => { waiting = false; if (isOpen(current)) showHead(current); }, 100);
}

async function showEnd(solve) {
  current = solve;
  showHead(solve);
  const { summary } = solve;
  history.end.textContent = summary ? `It ended as ${summary.outcome.replaceAll("_", " ")} after ${counted(summary.iterations, "iteration")}.` : `It is ${solve.status}.`;
  if (!summary) return picture.replaceChildren();
  try {
    await showResult(solve);
  } catch (error) {
    failed(error);
  }
}

try {
  current = await getJson(path);
  showHead(current);
  if (isOpen(current)) picture.replaceChildren(element("p", { className: "quiet" }, "The picture comes when it is solved."));
  await follow(current.links.events, tell, (away) => { history.whole.classList.toggle("away", away); if (away) history.end.textContent = isAway; else if (isOpen(current)) history.end.textContent = ""; });
} catch (error) {
  if (!current) {
    head.replaceChildren(element("h1", {}, "A solve"));
    history.whole.remove();
  }
  failed(error);
}
