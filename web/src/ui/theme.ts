// Light or dark: as the system has it, until somebody chooses.
import { createStore } from "../api/store";
import { kept } from "../api/storage";

export type Theme = "system" | "light" | "dark";
const key = "docent.theme";
const dark = window.matchMedia("(prefers-color-scheme: dark)");
let chosen: Theme = readChosen();
const shown = createStore(themeShown());

function readChosen(): Theme {
  const stored = kept.getItem(key);
  return stored === "light" || stored === "dark" ? stored : "system";
}
function apply() {
  document.documentElement.dataset["theme"] = themeShown();
  shown.set(themeShown());
}
export function themeShown(): "light" | "dark" {
  return chosen === "system" ? (dark.matches ? "dark" : "light") : chosen;
}
export function toggleTheme() {
  chosen = themeShown() === "dark" ? "light" : "dark";
  kept.setItem(key, chosen);
  apply();
}
export function startTheme() {
  // Paper is light.
  window.addEventListener("beforeprint", () => (document.documentElement.dataset["theme"] = "light"));
  window.addEventListener("afterprint", apply);
  dark.addEventListener("change", apply);
  apply();
}
export const useTheme = shown.use;
