// What every page has around its subject: where to go, and the theme.

import { aria, element } from "/pages/element.js";

const isDark = () => document.documentElement.dataset.theme === "dark";

function themeButton() {
  const button = element("button", { type: "button", className: "last" });
  const name = () => { button.textContent = isDark() ? "Light" : "Dark"; };
  aria(button, { "aria-label": "Change between dark and light" });
  button.addEventListener("click", () => {
    const theme = isDark() ? "light" : "dark";
    document.documentElement.dataset.theme = theme;
    localStorage.setItem("theme", theme);
    dispatchEvent(new Event("themechange"));
  });
  addEventListener("themechange", name);
  name();
  return button;
}

/// Adds the head of the page and returns its main part, empty.
export function shell() {
  const here = location.pathname;
  const link = (path, text) => {
    const made = element("a", { href: path }, text);
    return here === path ? aria(made, { "aria-current": "page" }) : made;
  };
  const brand = element("a", { href: "/", className: "brand" }, element("img", { src: "/pages/icon.svg", alt: "" }), "Signorini");
  document.body.prepend(
    element("a", { className: "skip", href: "#main" }, "To the content"),
    element("header", {}, aria(element("nav", { className: "top" }, brand, link("/v1/solves", "Solves"), link("/docs", "Interface"), themeButton()), { "aria-label": "Pages" })));
  const main = document.getElementById("main");
  main.replaceChildren();
  return main;
}
