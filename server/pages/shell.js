// What every page has around its subject: where to go, and the theme.

import { button, element } from "/pages/element.js";

const isDark = () => document.documentElement.dataset.theme === "dark";

function themeButton() {
  const own = button("", () => {
    const theme = isDark() ? "light" : "dark";
    document.documentElement.dataset.theme = theme;
    localStorage.setItem("theme", theme);
    dispatchEvent(new Event("themechange"));
  }, { ariaLabel: "Change between dark and light" });
  const name = () => { own.textContent = isDark() ? "Light" : "Dark"; };
  addEventListener("themechange", name);
  name();
  return own;
}

/// Who has a token may enter another one.
function tokenButton() {
  const own = button("Forget token", () => { sessionStorage.removeItem("token"); location.reload(); });
  const show = () => { own.hidden = !sessionStorage.getItem("token"); };
  addEventListener("tokenchange", show);
  show();
  return own;
}

/// Adds the head of the page and returns its main part, empty.
export function shell() {
  const here = location.pathname;
  const link = (path, text) => element("a", { href: path, ariaCurrent: here === path ? "page" : null }, text);
  const brand = element("a", { href: "/", className: "brand" }, element("img", { src: "/pages/icon.svg", alt: "" }), "Signorini");
  document.body.prepend(
    element("a", { className: "skip", href: "#main" }, "To the content"),
    element("header", {}, element("nav", { className: "top", ariaLabel: "Pages" }, brand, link("/v1/solves", "Solves"), link("/docs", "Interface"), element("span", { className: "row last" }, tokenButton(), themeButton()))));
  const main = document.getElementById("main");
  main.replaceChildren();
  return main;
}
