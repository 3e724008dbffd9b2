// The tour that is being made, kept in this tab: it is there again after another view, and after the page was loaded again.
import { useState } from "react";
import { keptInTab } from "../api/storage";
import type { Stop } from "../cawl/tour";

export interface TourDraft {
  stops: readonly Stop[];
  name: string;
  travel: string; // empty: what is proposed
  present: readonly string[] | null; // null: what is proposed
  wait: boolean; // for the visitor, at each stop
  near: boolean; // drive only while the visitor is near
}
export const newTour: TourDraft = {
  stops: [],
  name: "Tour",
  travel: "",
  present: null,
  wait: true,
  near: false,
};
const key = "docent.tour";

export function readTour(text: string | null): TourDraft | null {
  try {
    const stored = JSON.parse(text ?? "null") as Partial<TourDraft> | null;
    if (!stored || !Array.isArray(stored.stops)) return null;
    const stops = (stored.stops as Partial<Stop>[]).filter(
      (s): s is Stop =>
        typeof s?.iri === "string" &&
        typeof s.term === "string" &&
        typeof s.name === "string" &&
        typeof s.x === "number" &&
        typeof s.y === "number",
    );
    return { ...newTour, ...stored, stops };
  } catch {
    return null;
  }
}

// Null: none is being made.
export function useTourDraft(): [TourDraft | null, (tour: TourDraft | null) => void] {
  const [tour, setTour] = useState(() => readTour(keptInTab.getItem(key)));
  return [
    tour,
    (next) => {
      if (next) keptInTab.setItem(key, JSON.stringify(next));
      else keptInTab.removeItem(key);
      setTour(next);
    },
  ];
}
