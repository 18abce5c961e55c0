// What the pages are made of. Texts are never read as HTML.

/// An element with properties and children; children that are texts stay texts.
export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined && child !== false && child !== ""));
  return made;
}

/// The same for SVG, with attributes.
export function drawn(tag, attributes = {}, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children.flat(Infinity));
  return made;
}

export function button(text, does, properties = {}) {
  return element("button", { type: "button", onclick: does, ...properties }, text);
}

/// The head of a column.
export const column = (name, className = "") => element("th", { className, scope: "col" }, name);

/// A number for people, with so many digits.
export function short(number, digits = 4) {
  if (number === null || number === undefined || Number.isNaN(number)) return "–";
  if (number === 0) return "0";
  const size = Math.abs(number);
  if (Number.isInteger(number) && size < 1e9) return number.toLocaleString("en").replaceAll(",", "\u202f").replace("-", "−");
  const text = size >= 1e5 || size < 1e-3 ? number.toExponential(digits - 1) : number.toPrecision(digits);
  const plain = text.includes("e") ? text.replace(/\.?0+e/, "e") : text.includes(".") ? text.replace(/\.?0+$/, "") : text;
  return plain.replace(/e\+?(-?)(\d+)/, (_, sign, power) => `\u202f·\u202f10${superscript(sign + power)}`).replace(/^(-?)1\u202f·\u202f/, "$1").replace("-", "−");
}
const superscript = (text) => [...text].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");

export const counted = (count, name) => `${short(count)} ${name}${count === 1 ? "" : "s"}`;
export const percent = (share) => `${short(share < 0.0995 ? 100 * share : Math.round(100 * share), 2)} %`;
export const seconds = (time) => (time < 0.0995 ? `${short(1000 * time, 2)} ms` : time < 99.5 ? `${short(time, 3)} s` : `${short(time / 60, 2)} min`);
export const boundInWords = (bound) => (bound ? `${percent(bound.relative)}${bound.guaranteed ? "" : ", not proved"}` : "–");
export function bytes(count) {
  const power = count > 0 ? Math.min(4, Math.floor(Math.log(count) / Math.log(1024))) : 0;
  return `${short(count / 1024 ** power, 3)} ${["bytes", "KiB", "MiB", "GiB", "TiB"][power]}`;
}

/// How far a solve that runs is.
export function progressInWords({ phase, iteration, residual, level, sweep, study }) {
  const several = sweep ?? study;
  return [phase, several && `${several.done} of ${several.count}`, level && `level ${level.number}, ${counted(level.triangles, "triangle")}`,
    iteration > 0 && `iteration ${short(iteration)}`, residual > 0 && `residual ${short(residual, 2)}`].filter(Boolean).join(" · ");
}

/// A table of numbers: names of the columns, and rows.
export function table(caption, names, rows) {
  const head = element("tr", {}, names.map((name, i) => column(name, i ? "number" : "")));
  const cell = (value, i) => element("td", { className: i ? "number" : "" }, typeof value === "number" ? short(value, 6) : value);
  return element("div", { className: "scroll", tabIndex: 0, role: "region", ariaLabel: caption }, element("table", {}, element("caption", {}, caption), element("thead", {}, head),
    element("tbody", {}, rows.map((row) => element("tr", {}, row.map(cell))))));
}

export const state = (status) => element("span", { className: `state ${status}` }, status);
export const isOpen = ({ status }) => status === "queued" || status === "running";

/// Each leads to the solves that have it.
export const tagLinks = (tags) => tags.map((tag) => element("a", { href: `/v1/solves?${new URLSearchParams({ tag })}` }, tag));

/// A download of bytes that the page has made.
export function save(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
