// The time that the views of hall and runs show: now, or one of the past. It stands in the address (?t=2026-11-26T10:40:31.072Z),
// and goes along from view to view.
import { createStore } from "./store";

const parameter = "t";
const addressMs = 300; // a time that is dragged comes into the address when it rests

const shownMs = createStore<number | null>(null);
let timer: ReturnType<typeof setTimeout> | undefined;

export function readTime(search: string): number | null {
  const ms = Date.parse(new URLSearchParams(search).get(parameter) ?? "");
  return Number.isFinite(ms) ? ms : null;
}
// As queries of the past take it.
export const timeText = (ms: number) => new Date(ms).toISOString();

// Called by the router when the address has changed.
export function followAddress() {
  clearTimeout(timer);
  shownMs.set(readTime(window.location.search));
}

// Null: now, from here on.
export function showTime(ms: number | null) {
  shownMs.set(ms === null ? null : Math.round(ms));
  clearTimeout(timer);
  timer = setTimeout(() => {
    const url = new URL(window.location.href);
    const text = timeInAddress();
    if (text === "") url.searchParams.delete(parameter);
    else url.searchParams.set(parameter, text);
    window.history.replaceState(null, "", url.pathname + url.search);
  }, addressMs);
}

// For addresses of views that show the past, too: "" now.
export function timeInAddress(): string {
  const ms = shownMs.get();
  return ms === null ? "" : timeText(ms);
}

let aheadMs = 0; // of the server's clock
const leastMs = 1500; // a smaller difference is the way of the answer
export function serverIsAhead(ms: number) {
  aheadMs = Math.abs(ms) < leastMs ? 0 : ms;
}
export const serverNow = () => Date.now() + aheadMs;
// The time that is shown, in ms since 1970, by the server's clock.
export const shownNow = () => shownMs.get() ?? serverNow();

export const usePast = shownMs.use;
