// Addresses of views: every view is a URL that restores it. Paths only; what a view keeps beside its name is in the query.
// The time that a view shows is in the query as well, and the paths of those that can show the past take it along (past.ts).
import { createStore } from "../api/store";
import { leaveField } from "./typed";
import { followAddress, timeInAddress } from "../api/past";

export type Route =
  | { view: "documents" }
  | { view: "compose"; name: string; flow: string; step: string; via: string; trial: string }
  | { view: "runs"; state: string; workflow: string }
  | { view: "run"; run: string; node: string }
  | { view: "hall"; picked: string }
  | { view: "board" }
  | { view: "desk"; search: string }
  | { view: "unknown"; path: string };

export function parseRoute(url: URL): Route {
  const [first = "", second = ""] = url.pathname.split("/").filter(Boolean).map(decode);
  const get = (name: string) => url.searchParams.get(name) ?? "";
  if (first === "" || (first === "compose" && second === "")) return { view: "documents" };
  if (first === "compose")
    return {
      view: "compose",
      name: second,
      flow: get("flow"),
      step: get("step"),
      via: get("via"),
      trial: get("trial"),
    };
  if (first === "runs")
    return second
      ? { view: "run", run: runOfAddress(second), node: get("node") }
      : { view: "runs", state: get("state"), workflow: get("workflow") };
  if (first === "hall") return { view: "hall", picked: get("at") };
  if (first === "board") return { view: "board" };
  if (first === "desk") return { view: "desk", search: url.search };
  return { view: "unknown", path: url.pathname };
}

function decode(part: string): string {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
}

// An id of a run has its workflow's name percent-encoded ("John's%20Service-2"); in addresses it is encoded once, as all else is.
function runOfAddress(text: string): string {
  return /%[0-9A-F]{2}/.test(text)
    ? text
    : text.replace(
        /[%/?#$@<>"{}|\\^`\u0000-\u0020\u007f]/g,
        (c) => `%${c.charCodeAt(0).toString(16).toUpperCase().padStart(2, "0")}`,
      );
}

export const paths = {
  documents: () => "/compose",
  compose: (name: string, flow = "", step = "", via = "") =>
    `/compose/${encodeURIComponent(name)}${query({ flow, step, via })}`,
  trial: (name: string, flow: string, trial: string) =>
    `/compose/${encodeURIComponent(name)}${query({ flow, trial })}`, // tries a past run
  runs: (state = "", workflow = "") => `/runs${query({ state, workflow, t: timeInAddress() })}`,
  run: (id: string, node = "") =>
    `/runs/${encodeURIComponent(decode(id))}${query({ node, t: timeInAddress() })}`,
  hall: (at = "") => `/hall${query({ at, t: timeInAddress() })}`,
  board: () => `/board${query({ t: timeInAddress() })}`,
  desk: (search = "") => `/desk${search}`,
};

function query(values: Record<string, string>): string {
  const text = new URLSearchParams(Object.entries(values).filter(([, value]) => value !== "")).toString();
  return text ? `?${text}` : "";
}

const address = createStore("");
function changed() {
  followAddress();
  address.set(window.location.href);
}
// To be called once, at the start.
export function startRouter() {
  window.addEventListener("popstate", () => {
    const { href } = window.location;
    leaveField(); // in the view that is left
    if (window.location.href !== href) window.history.replaceState(null, "", href); // that view may have written its new address here
    changed();
  });
  // Before anything keeps what is written: a reload, or another site.
  for (const event of ["beforeunload", "pagehide"])
    window.addEventListener(event, leaveField, { capture: true });
  followAddress();
}

// `replace`: where the view stays and only its details change, so that Back leads to the view before.
export function navigate(path: string, replace = false) {
  if (path === window.location.pathname + window.location.search) return;
  window.history[replace ? "replaceState" : "pushState"](null, "", path);
  changed();
}

export function useRoute(): Route {
  address.use();
  return parseRoute(new URL(window.location.href));
}
