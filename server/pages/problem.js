// An example: its picture and its text, to change and to solve.

import { element } from "/pages/element.js";
import { editor } from "/pages/editor.js";
import { ask } from "/pages/service.js";
import { shell } from "/pages/shell.js";

const main = shell();
const path = location.pathname;
try {
  const text = await (await ask(path, { headers: { Accept: "application/json" } })).text();
  const { title, model } = JSON.parse(text);
  document.title = `${title} · Signorini`;
  main.append(element("h1", {}, title), element("p", { className: "quiet" }, `Example `, element("code", {}, decodeURIComponent(path.split("/").at(-1))), `, ${model}`),
    element("div", { className: "beside" },
      element("div", { className: "card picture" }, element("img", { src: `${path}/picture.svg`, alt: `What the solved example looks like` })),
      editor({ text }).whole));
} catch (error) {
  main.append(element("h1", {}, "Example"), element("p", { className: "fault", role: "alert" }, error.message));
}
