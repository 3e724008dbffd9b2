// The time that the views of hall and runs show: now, or one of the past. It stands in the address (?t=2026-11-26T10:40:31.072Z),
// and goes along from view to view.
import { useSyncExternalStore } from "react";

const parameter = "t";
const addressMs = 300; // a time that is dragged comes into the address when it rests

let shownMs: number | null = null;
let timer: ReturnType<typeof setTimeout> | undefined;
const listeners = new Set<() => void>();

export function readTime(search: string): number | null {
  const ms = Date.parse(new URLSearchParams(search).get(parameter) ?? "");
  return Number.isFinite(ms) ? ms : null;
}
// As queries of the past take it.
export const timeText = (ms: number) => new Date(ms).toISOString();

function become(ms: number | null) {
  if (ms === shownMs) return;
  shownMs = ms;
  for (const listener of listeners) listener();
}

// Called by the router when the address has changed.
export function followAddress() {
  clearTimeout(timer);
  become(readTime(window.location.search));
}

// Null: now, from here on.
export function showTime(ms: number | null) {
  become(ms === null ? null : Math.round(ms));
  clearTimeout(timer);
  timer = setTimeout(() => {
    const url = new URL(window.location.href);
    if (shownMs === null) url.searchParams.delete(parameter);
    else url.searchParams.set(parameter, timeText(shownMs));
    window.history.replaceState(null, "", url.pathname + url.search);
  }, addressMs);
}

// For addresses of views that show the past, too: "" now.
export const timeInAddress = () => (shownMs === null ? "" : timeText(shownMs));

let aheadMs = 0; // of the server's clock
const leastMs = 1500; // a smaller difference is the way of the answer
export function serverIsAhead(ms: number) {
  aheadMs = Math.abs(ms) < leastMs ? 0 : ms;
}
export const serverNow = () => Date.now() + aheadMs;
// The time that is shown, in ms since 1970, by the server's clock.
export const shownNow = () => shownMs ?? serverNow();

export function usePast(): number | null {
  return useSyncExternalStore(
    (listener) => (listeners.add(listener), () => listeners.delete(listener)),
    () => shownMs,
  );
}
