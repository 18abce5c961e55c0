// Questions that stand over a page until they are answered.

import { button, element } from "/pages/element.js";

/// Resolves to true if the form is sent, to false by Escape or the button `no`.
export function asked(children, yes, no) {
  return new Promise((answer) => {
    const form = element("form", { method: "dialog" }, element("div", {}, children), element("div", { className: "row" }, element("button", { className: "main", value: "yes" }, yes), button(no, () => dialog.close())));
    const dialog = element("dialog", {}, form);
    dialog.onclose = () => { dialog.remove(); answer(dialog.returnValue === "yes"); };
    document.body.append(dialog);
    dialog.showModal();
  });
}
