// The page's address: the place of the code that was scanned, and what is being chosen. Back leads to the choice before.
import { createStore } from "../api/store";

export interface Choice {
  at: string; // as the code or the link names it
  service: string;
  booth: string;
  step: string; // "at", "service" or "booth": that is chosen again
}
const names = ["at", "service", "booth", "step"] as const;
const address = createStore(window.location.search);
const tell = () => address.set(window.location.search);
window.addEventListener("popstate", tell);

export function readChoice(search: string): Choice {
  const values = new URLSearchParams(search);
  return Object.fromEntries(names.map((name) => [name, values.get(name) ?? ""])) as unknown as Choice;
}
export function useChoice(): Choice {
  return readChoice(address.use());
}
export function choose(values: Partial<Choice>, replace = false) {
  const search = new URLSearchParams(window.location.search);
  for (const [name, value] of Object.entries(values)) {
    if (value) search.set(name, value);
    else search.delete(name);
  }
  const text = search.toString();
  window.history[replace ? "replaceState" : "pushState"](
    null,
    "",
    `${window.location.pathname}${text && `?${text}`}`,
  );
  tell();
}
