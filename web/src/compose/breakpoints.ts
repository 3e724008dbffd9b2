// Breakpoints of a workflow: steps at which a simulation stops. Kept in this browser by the workflow's name, and never in its text.
import { useCallback, useMemo, useState } from "react";

const prefix = "docent.breakpoints.";
const placeOf = (flow: string, step: string) => `${flow}\n${step}`;

function load(workflow: string): ReadonlySet<string> {
  try {
    const stored: unknown = JSON.parse(localStorage.getItem(prefix + workflow) ?? "[]");
    return new Set(Array.isArray(stored) ? stored.filter((place) => typeof place === "string") : []);
  } catch {
    return new Set();
  }
}
function save(workflow: string, places: ReadonlySet<string>) {
  try {
    if (places.size > 0) localStorage.setItem(prefix + workflow, JSON.stringify([...places]));
    else localStorage.removeItem(prefix + workflow);
  } catch {
    // The browser's storage is full or closed: they last as long as the page.
  }
}

// Of one flow of the workflow that is open: the names of its steps that have one.
export function useBreakpoints(workflow: string, flow: string): { steps: ReadonlySet<string>; toggle: (step: string) => void } {
  const [places, setPlaces] = useState(() => load(workflow));
  const toggle = useCallback((step: string) => setPlaces((before) => {
    const after = new Set(before);
    if (!after.delete(placeOf(flow, step))) after.add(placeOf(flow, step));
    save(workflow, after);
    return after;
  }), [workflow, flow]);
  const steps = useMemo(() => new Set([...places].filter((place) => place.startsWith(placeOf(flow, ""))).map((place) => place.slice(placeOf(flow, "").length))), [places, flow]);
  return { steps, toggle };
}
