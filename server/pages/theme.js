// Before the page is drawn: the theme that was chosen here, else that of the system.
{
  const system = matchMedia("(prefers-color-scheme: dark)");
  const show = () => { document.documentElement.dataset.theme = localStorage.getItem("theme") ?? (system.matches ? "dark" : "light"); };
  system.onchange = () => { show(); dispatchEvent(new Event("themechange")); };
  show();
}
