// The start: what this is, the examples as pictures, and a place for an own problem.

import { button, element } from "/pages/element.js";
import { editor } from "/pages/editor.js";
import { ask, getJson, pose } from "/pages/service.js";
import { shell } from "/pages/shell.js";

const main = shell();

async function solveExample(name, own, notice) {
  own.disabled = true;
  try {
    await pose(JSON.stringify(await getJson(`/v1/examples/${name}`)));
  } catch (error) {
    notice.textContent = error.message;
    own.disabled = false;
  }
}

function card({ name, title, links }) {
  const notice = element("p", { className: "fault small", role: "status" });
  const solve = button("Solve", () => solveExample(name, solve, notice), { ariaLabel: `Solve ${name}` });
  return element("li", { className: "card example" },
    element("a", { href: links.self, className: "picture", tabIndex: -1, ariaHidden: "true" },
      element("img", { src: `${links.self}/picture.svg`, alt: "", loading: "lazy", width: 730, height: 374 })),
    element("h3", {}, element("a", { href: links.self }, title)),
    element("div", { className: "row" }, solve, element("span", { className: "quiet code" }, name)), notice);
}

const gallery = element("ul", { className: "gallery" });
const own = editor({ text: "" });
main.append(
  element("h1", {}, "Contact without friction, with a proved error"),
  element("p", { className: "lead" },
    "A body under load touches a rigid foundation, presses on it and lifts off. This service solves the problem in the plane by ",
    "dual mixed finite elements, and says by how much the answer can be off: a bound that is proved, not estimated."),
  element("p", { className: "row" }, element("a", { className: "button", href: "#own" }, "Write a problem"),
    element("a", { className: "button", href: "/v1/solves" }, "See what was solved"), element("a", { className: "button", href: "/docs" }, "Read the interface")),
  element("h2", {}, "Examples"), gallery,
  element("h2", { id: "own" }, "A problem of your own"),
  element("p", { className: "quiet" }, "It is checked as you type. Ctrl-Space lists what may stand at the cursor."), own.whole);

try {
  const { examples } = await getJson("/v1/examples");
  gallery.append(...examples.map(card));
  own.fill(await (await ask("/v1/examples/elastic-block", { headers: { Accept: "application/json" } })).text());
} catch (error) {
  gallery.replaceChildren(element("li", { className: "fault" }, error.message));
}
