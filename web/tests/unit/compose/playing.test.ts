// Playing a simulation in ticks: it stops at breakpoints and at its end, whatever the machine does in between.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { playOn, type Shown } from "../../../src/compose/playing";
import type { SimulationEvent } from "../../../src/compose/simulation";

const events = [0, 4, 20, 23].map((afterS) => ({ afterS })) as SimulationEvent[];
const begin = { afterS: 0, done: 0 };

describe("playing", () => {
  let shown: Shown[];
  const play = (stops: number[], from = begin, speed = 60) =>
    playOn(from, { events, endS: 23, stops }, speed, (s) => shown.push(s));
  beforeEach(() => {
    shown = [];
    vi.useFakeTimers();
  });
  afterEach(() => void vi.useRealTimers());

  it("stops at a breakpoint for good: no tick that comes late goes past it", () => {
    play([2]);
    vi.advanceTimersByTime(60_000);
    expect(shown.at(-1)).toEqual({ head: { afterS: 20, done: 3 }, stop: 2, over: true });
    expect(shown.filter((s) => s.over)).toHaveLength(1);
  });
  it("goes on from a breakpoint to its end, and ends once", () => {
    play([2], { afterS: 20, done: 3 });
    vi.advanceTimersByTime(60_000);
    expect(shown).toEqual([{ head: { afterS: 23, done: 4 }, stop: -1, over: true }]);
  });
  it("plays as fast as it is said, from its own head and not from what is drawn", () => {
    play([], begin, 10);
    vi.advanceTimersByTime(1000);
    expect(shown).toHaveLength(10);
    expect(shown.at(-1)?.head.afterS).toBeCloseTo(10, 5);
    expect(shown.at(-1)?.head.done).toBe(2);
  });
  it("can be ended from outside", () => {
    const end = play([]);
    vi.advanceTimersByTime(100);
    end();
    vi.advanceTimersByTime(60_000);
    expect(shown).toHaveLength(1);
  });
});
