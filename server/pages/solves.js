// The solves: what waits, runs and has ended, as it happens.

import { asked } from "/pages/dialog.js";
import { boundInWords, button, column, counted, element, isOpen, percent, progressInWords, short, state, tagLinks } from "/pages/element.js";
import { ask, getJson, isAway, Unreached } from "/pages/service.js";
import { shell } from "/pages/shell.js";

const pause = 1000; // ms between two looks

const main = shell();
const rows = new Map(); // id → { row, solve, box, cells }
let count = 50;

const query = new URLSearchParams(location.search);
const status = element("select", {}, ["", "queued", "running", "succeeded", "failed", "cancelled"].map((value) => element("option", { value }, value || "any")));
status.value = query.get("status") ?? "";
const title = element("input", { type: "search", value: query.get("title") ?? "", placeholder: "part of it" });
const tag = element("input", { type: "search", value: query.get("tag") ?? "", placeholder: "the whole of it" });
const cancel = button("Cancel", () => dismiss(chosen().filter(({ solve }) => isOpen(solve))));
const remove = button("Delete", async () => {
  const own = chosen().filter(({ solve }) => !isOpen(solve));
  if (await asked(own.length === 1 ? ["Delete “", element("bdi", {}, own[0].solve.title || "without a title"), "” and its result?"] : `Delete ${own.length} solves and their results?`, "Delete", "Keep")) dismiss(own);
});
const all = element("input", { type: "checkbox", ariaLabel: "Choose all" });
const compare = element("a", { className: "button", hidden: true }, "Side by side");
const more = button("Show more", () => { count = Math.min(1000, 4 * count); look(); }, { hidden: true });
const said = element("p", { className: "quiet", role: "status" }, "Loading …");
const body = element("tbody"), names = ["Title", "State", "Progress", "Error bound", "Posted"];
main.append(element("h1", {}, "Solves"),
  element("div", { className: "row" }, element("label", {}, "Status ", status), element("label", {}, "Title ", title), element("label", {}, "Tag ", tag),
    element("span", { className: "row last" }, cancel, remove, compare)), said,
  element("div", { className: "card flush" }, element("table", { className: "solves" }, element("thead", {}, element("tr", {},
    [all, ...names].map((name) => column(name)))), body)),
  element("p", {}, more));

function progressOf({ status: own, progress, summary, error }) {
  if (error) return error.title;
  if (own === "queued") return "waits for a worker";
  if (own === "running") return progressInWords(progress);
  return summary ? `${counted(summary.triangles, "triangle")}, ${counted(summary.iterations, "iteration")}` : "";
}

function boundOf({ progress, summary }) {
  if (progress.level && !summary) return `${percent(progress.level.relative)} so far`;
  return summary ? boundInWords(summary.error_bound) : "";
}

const clock = new Intl.DateTimeFormat(undefined, { month: "short", day: "numeric", hour: "2-digit", minute: "2-digit" });

function show(solve) {
  let own = rows.get(solve.id);
  if (!own) {
    const box = element("input", { type: "checkbox" });
    const link = element("a", { href: solve.links.self });
    const cells = names.map((name) => { const cell = element("td"); cell.dataset.name = name; return cell; });
    const tags = element("span", { className: "tags" });
    cells[0].append(link, tags);
    own = { row: element("tr", {}, element("td", {}, box), cells), box, link, tags, cells };
    box.onchange = choose;
    rows.set(solve.id, own);
  }
  own.solve = solve;
  const name = solve.title || "without a title";
  own.link.textContent = name;
  if (own.tags.children.length !== solve.tags.length) own.tags.replaceChildren(...tagLinks(solve.tags));
  own.box.ariaLabel = `Choose ${name}`;
  own.cells[1].replaceChildren(state(solve.status));
  own.cells[2].textContent = progressOf(solve);
  own.cells[3].textContent = boundOf(solve);
  own.cells[4].textContent = clock.format(new Date(solve.created_at));
  return own.row;
}

const chosen = () => [...rows.values()].filter(({ box, row }) => box.checked && row.isConnected);

function choose() {
  const own = chosen(), open = own.filter(({ solve }) => isOpen(solve)), shown = [...rows.values()].filter(({ row }) => row.isConnected);
  cancel.disabled = !open.length;
  remove.disabled = open.length === own.length;
  cancel.textContent = open.length ? `Cancel ${open.length}` : "Cancel";
  remove.textContent = own.length > open.length ? `Delete ${own.length - open.length}` : "Delete";
  all.checked = own.length > 0 && own.length === shown.length;
  all.indeterminate = own.length > 0 && own.length < shown.length;
  compare.hidden = own.length !== 2 || own.some(({ solve }) => !solve.summary);
  if (!compare.hidden) compare.href = `${own[0].solve.links.self}#with=${own[1].solve.id}`;
}

const filters = () => Object.fromEntries(Object.entries({ status: status.value, title: title.value.trim(), tag: tag.value.trim() }).filter(([, value]) => value));

let looking = false, again = false;

async function look() {
  if (looking) { again = true; return; }
  looking = true;
  try {
    const { found, isAll } = await newest();
    const own = found.map(show);
    if (own.length !== body.children.length || own.some((row, i) => row !== body.children[i])) body.replaceChildren(...own);
    for (const [id, { row }] of rows) if (!row.isConnected) rows.delete(id);
    more.hidden = isAll || count >= 1000;
    const open = found.filter(isOpen).length;
    said.textContent = own.length ? `${short(own.length)} shown${open ? `, ${open} of them not ended` : ""}.` : Object.keys(filters()).length ? isAll ? "None is like that." : "None of the newest is like that." : "Nothing was posted yet.";
  } catch (error) {
    said.textContent = error instanceof Unreached ? isAway : error.message;
  }
  choose();
  looking = false;
  if (again) { again = false; look(); }
}

/// The newest solves that are meant. A search by title reads so many titles in each answer, and not for ever.
async function newest() {
  let found = [], next = `/v1/solves?${new URLSearchParams({ ...filters(), limit: count })}`;
  for (let i = 0; next && found.length < count && i < count / 10; ++i) {
    const { solves, links } = await getJson(next);
    found = found.concat(solves);
    ({ next } = links);
  }
  return { found, isAll: !next };
}

/// DELETE cancels what has not ended and removes what has.
async function dismiss(own) {
  const refused = (await Promise.allSettled(own.map(({ solve }) => ask(solve.links.self, { method: "DELETE" })))).filter((each) => each.status === "rejected");
  await look();
  if (refused.length) said.textContent = refused[0].reason.message;
}

all.onchange = () => {
  for (const { box, row } of rows.values()) box.checked = all.checked && row.isConnected;
  choose();
};
for (const control of [status, title, tag]) control.oninput = () => {
  const wanted = new URLSearchParams(filters());
  history.replaceState(null, "", wanted.size ? `?${wanted}` : location.pathname);
  look();
};
setInterval(() => { if (!document.hidden) look(); }, pause);
document.onvisibilitychange = () => { if (!document.hidden) look(); };
look();
