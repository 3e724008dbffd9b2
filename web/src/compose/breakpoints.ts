// Breakpoints of a workflow: steps at which a simulation stops. Kept in this browser by the workflow's name, and never in its text.
import { useCallback, useMemo, useState } from "react";
import { kept } from "../api/storage";

const prefix = "docent.breakpoints.";
const placeOf = (flow: string, step: string) => `${flow}\n${step}`;

function load(workflow: string): ReadonlySet<string> {
  try {
    const stored: unknown = JSON.parse(kept.getItem(prefix + workflow) ?? "[]");
    return new Set(Array.isArray(stored) ? stored.filter((place) => typeof place === "string") : []);
  } catch {
    return new Set();
  }
}
function save(workflow: string, places: ReadonlySet<string>) {
  if (places.size > 0) kept.setItem(prefix + workflow, JSON.stringify([...places]));
  else kept.removeItem(prefix + workflow);
}

// Of one flow of the workflow that is open: the names of its steps that have one.
export function useBreakpoints(
  workflow: string,
  flow: string,
): { steps: ReadonlySet<string>; toggle: (step: string) => void } {
  const [places, setPlaces] = useState(() => load(workflow));
  const toggle = useCallback(
    (step: string) =>
      setPlaces((before) => {
        const after = new Set(before);
        if (!after.delete(placeOf(flow, step))) after.add(placeOf(flow, step));
        save(workflow, after);
        return after;
      }),
    [workflow, flow],
  );
  const steps = useMemo(
    () =>
      new Set(
        [...places]
          .filter((place) => place.startsWith(placeOf(flow, "")))
          .map((place) => place.slice(placeOf(flow, "").length)),
      ),
    [places, flow],
  );
  return { steps, toggle };
}
