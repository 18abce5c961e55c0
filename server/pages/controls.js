// The controls of the picture, which set the view.

import { button, element, save, short } from "/pages/element.js";
import { mostTriangles, pngOf, svgOf } from "/pages/files.js";

/// `figures`: one, or two that are linked; `steps`: null, or the levels to step through.
export function controlsOf(figures, view, names, steps) {
  const [figure] = figures, free = { fixed: false, low: null, high: null };
  const field = element("select", {}, [...figure.fields.values()].map(({ key, name }) => element("option", { value: key }, name)));
  field.onchange = () => view.set({ field: field.value, ...free });

  const toggle = (name, text, possible = true) => {
    const own = button(text, () => view.set({ [name]: !state(name), ...(name === "difference" && free) }));
    own.hidden = !possible;
    return { name, own };
  };
  const state = (name) => (name === "surface" ? figure.shape.surface : view[name]);
  const toggles = [toggle("surface", "Surface", !figure.shape.body), toggle("mesh", "Mesh"), toggle("nodes", "Unknowns"), toggle("crosses", "Principal directions", figure.shape.body),
    toggle("smooth", "Smoothed"), toggle("difference", "Difference", figures.length > 1 && agree(figures))];

  const slider = element("input", { type: "range", min: 0, max: 1, step: "any", ariaLabel: figure.shape.body ? "Deformation, slider" : "Height, slider" }), exact = element("input", { type: "number", min: 0, step: "any", className: "short" });
  slider.oninput = () => view.set({ lift: Number((4 * figure.shape.usualLift * slider.valueAsNumber ** 2).toPrecision(3)) });
  exact.onchange = () => view.set({ lift: exact.value === "" ? null : Math.max(0, exact.valueAsNumber) });
  const lift = element("label", {}, figure.shape.body ? "Deformed ×" : "Height ×", exact, slider);

  const fixed = element("input", { type: "checkbox" }), low = element("input", { type: "number", step: "any", className: "short", ariaLabel: "Lowest value of the scale" }), high = element("input", { type: "number", step: "any", className: "short", ariaLabel: "Highest value of the scale" });
  fixed.onchange = () => view.set(fixed.checked ? { fixed: true, low: figure.scale.low, high: figure.scale.high } : free);
  for (const [name, input] of [["low", low], ["high", high]]) input.onchange = () => { if (input.value !== "") view.set({ fixed: true, low: view.low ?? figure.scale.low, high: view.high ?? figure.scale.high, [name]: input.valueAsNumber }); };

  const each = (use) => figures.forEach((own, i) => use(own, `${names[i]}-${own.field.key}`));
  const svg = button("SVG", () => each((own, name) => save(`${name}.svg`, new Blob([svgOf(own)], { type: "image/svg+xml" }))));
  svg.disabled = figures.some((own) => own.shape.count > mostTriangles);
  if (svg.disabled) svg.title = `Only of up to ${short(mostTriangles)} triangles`;
  const link = button("Copy link", async () => {
    view.writeAddress();
    const copied = navigator.clipboard?.writeText(location.href).then(() => "Copied");
    link.textContent = await copied?.catch(() => null) ?? "It is in the address bar";
    setTimeout(() => { link.textContent = "Copy link"; }, 1500);
  });

  const level = element("input", { type: "range", min: 1, max: steps?.count, step: 1, ariaLabel: "Level" }), told = element("span");
  level.oninput = () => view.set({ level: level.valueAsNumber });

  const show = () => {
    field.value = figure.field.key;
    for (const { name, own } of toggles) own.ariaPressed = Boolean(state(name));
    if (document.activeElement !== exact) exact.value = figure.shape.lift;
    if (document.activeElement !== slider) slider.value = Math.min(1, Math.sqrt(figure.shape.lift / (4 * figure.shape.usualLift)));
    if (steps) told.textContent = `${(level.value = steps.shown())} of ${steps.count}`;
    lift.hidden = !figure.shape.body && !figure.shape.surface;
    fixed.checked = view.fixed;
    if (figure.scale) for (const [name, input] of [["low", low], ["high", high]]) if (document.activeElement !== input) input.value = Number(((view.fixed ? view[name] : null) ?? figure.scale[name]).toPrecision(6));
  };
  figure.onDrawn = show;
  show();
  return element("div", { className: "controls", role: "group", ariaLabel: "What the picture shows" },
    element("div", { className: "row" }, element("label", {}, "Field", field), steps && element("label", {}, "Level", level, told), toggles.map(({ own }) => own)),
    element("div", { className: "row" }, lift, element("label", {}, "Scale", low, "to", high), element("label", {}, fixed, "Fixed"),
      element("span", { className: "row last" }, button("Whole view", () => view.reset()), button("PNG", () => each(async (own, name) => save(`${name}.png`, await pngOf(own)))), svg, link)));
}

/// Whether the meshes of both are the same.
export function agree([a, b]) {
  const same = (one, other) => one.length === other.length && one.every((value, i) => value === other[i]);
  return a.shape.body === b.shape.body && a.field.corners === b.field.corners && same(a.result.mesh.triangles, b.result.mesh.triangles) && same(a.result.mesh.points, b.result.mesh.points);
}
