// Light or dark: as the system has it, until somebody chooses.
import { useSyncExternalStore } from "react";
import { kept } from "../api/storage";

export type Theme = "system" | "light" | "dark";
const key = "docent.theme";
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const listeners = new Set<() => void>();
let chosen: Theme = readChosen();

function readChosen(): Theme {
  const stored = kept.getItem(key);
  return stored === "light" || stored === "dark" ? stored : "system";
}
function apply() {
  document.documentElement.dataset["theme"] = themeShown();
  for (const listener of listeners) listener();
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
export function useTheme(): "light" | "dark" {
  return useSyncExternalStore(
    (listener) => (listeners.add(listener), () => listeners.delete(listener)),
    themeShown,
  );
}
