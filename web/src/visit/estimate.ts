// When a robot comes: by its way, its speed and who is before the visitor. Pure functions.
import type { Point } from "../hall/layout";
import type { Sentence } from "./journey";

const usualMS = 0.6; // metres a second of a guide robot in a hall with people
const detour = 1.3; // of a way around booths against a straight line
const shortestWayM = 1.5; // to compare speeds over
const rememberedMs = 8000;

export interface Sighting extends Point {
  ms: number;
}

// What has been seen of a robot's way in the last seconds, with where it is now.
export function withSighting(seen: readonly Sighting[], now: Sighting): Sighting[] {
  const last = seen.at(-1);
  if (last && last.x === now.x && last.y === now.y && now.ms - last.ms < 1000) return [...seen];
  return [...seen.filter((s) => now.ms - s.ms <= rememberedMs), now];
}

// Metres a second over the last seconds, where it has gone far enough to tell; else the usual speed.
export function speedOf(seen: readonly Sighting[]): number {
  let metres = 0;
  for (let i = 1; i < seen.length; i++)
    metres += Math.hypot(
      (seen[i]?.x ?? 0) - (seen[i - 1]?.x ?? 0),
      (seen[i]?.y ?? 0) - (seen[i - 1]?.y ?? 0),
    );
  const seconds = ((seen.at(-1)?.ms ?? 0) - (seen[0]?.ms ?? 0)) / 1000;
  return metres >= shortestWayM && seconds > 0 ? Math.max(0.1, metres / seconds) : usualMS;
}

export function metresTo(from: Point, to: Point): number {
  return Math.hypot(from.x - to.x, from.y - to.y) * detour;
}

// Seconds until a robot that is on its way is there.
export function secondsToGo(from: Point, to: Point, seen: readonly Sighting[]): number {
  return metresTo(from, to) / speedOf(seen);
}

// Seconds that `before` visitors take, by how long runs have taken so far; null: nothing is known of it.
export function secondsInQueue(before: number, tookS: readonly number[]): number | null {
  if (tookS.length === 0) return before === 0 ? 0 : null;
  const sorted = [...tookS].sort((a, b) => a - b);
  return before * (sorted[Math.floor(sorted.length / 2)] ?? 0);
}

export function etaWords(seconds: number): Sentence {
  return seconds < 50
    ? { word: "eta.soon" }
    : { word: "eta.minutes", values: { minutes: Math.max(1, Math.round(seconds / 60)) } };
}
