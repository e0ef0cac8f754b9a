// Before the first paint: the colors of the system, or the reader's own choice for as long as the page is open.
"use strict";
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const wanted = /theme=(dark|light)/.exec(location.hash);
  let choice = wanted ? wanted[1] : "auto";
  function apply() {
    document.documentElement.dataset.theme = choice === "auto" ? (dark.matches ? "dark" : "light") : choice;
    const button = document.getElementById("theme");
    if (button) button.textContent = "Theme: " + choice;
    dispatchEvent(new Event("theme"));
  }
  dark.addEventListener("change", apply);
  apply();
  addEventListener("DOMContentLoaded", () => {
    document.getElementById("theme").addEventListener("click", () => {
      choice = { auto: "light", light: "dark", dark: "auto" }[choice];
      apply();
    });
    apply();
  });
})();
