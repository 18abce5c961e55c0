// The residuals of each iteration, live; a solve that is begun anew tells all of them again.

import { counted, element, table } from "/pages/element.js";
import { plot } from "/pages/plot.js";
import { section } from "/pages/sections.js";

const names = { displacement_change: "change of the displacement", equilibrium: "equilibrium", penetration: "penetration", tension: "tension", complementarity: "complementarity", clearance_change: "change of the clearance" };
const mostDrawn = 2000; // rows of a curve; more cannot be seen

export class History {
  constructor() {
    this.rows = [];
    this.run = "";
    this.drawn = element("div");
    this.details = element("details", {}, element("summary", {}, "Numbers of the history"));
    this.details.ontoggle = () => this.showTable();
    this.end = element("p", { role: "status" });
    this.whole = section("history", "History", this.end, this.drawn, this.details);
  }

  /// `id` is that of the event: RUN-ROWS.
  add(id, row) {
    const [run, count] = id.split("-");
    if (run !== this.run) this.rows = [];
    this.run = run;
    if (Number(count) !== this.rows.length + 1) return;
    this.rows.push(row);
    this.schedule();
  }

  schedule() {
    if (this.scheduled) return;
    this.scheduled = true;
    // Not by the next picture of the screen: a page in the background has none, and its rows would pile up unseen.
    setTimeout(() => { this.scheduled = false; this.show(); }, 50);
  }

  show() {
    const step = Math.ceil(this.rows.length / mostDrawn), rows = this.rows.filter((_, i) => i % step === 0 || i === this.rows.length - 1);
    const curves = Object.entries(names).map(([key, name], curve) => ({ name, values: rows.map((row) => row[key] ?? NaN), dots: rows.length < 40, curve })).filter(({ values }) => values.some((value) => value > 0));
    this.drawn.replaceChildren(curves.length ? plot({ label: "Residuals by iteration", x: { name: "iteration", values: rows.map((row) => row.iteration), whole: true }, y: { name: "residual", log: true }, curves, high: 300 }) : element("p", { className: "quiet" }, "No residual above zero."));
    this.drawn.dataset.rows = this.rows.length;
    this.showTable();
  }

  showTable() {
    if (!this.details.open) return;
    const keys = ["iteration", ...Object.keys(names), "active", "seconds"].filter((key) => this.rows.some((row) => key in row));
    this.details.replaceChildren(this.details.firstChild, table(counted(this.rows.length, "iteration"), keys.map((key) => names[key] ?? key), this.rows.slice(-1000).map((row) => keys.map((key) => row[key] ?? "–"))));
  }
}
