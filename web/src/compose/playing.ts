// The playhead of a simulation: it plays at a speed, stops at breakpoints, and goes from event to event.
import { useEffect, useRef, useState } from "react";
import { advance, headAfter, headAt, type Head, type SimulationEvent } from "./simulation";

export const speeds = [1, 10, 60] as const;
const tickMs = 100;
const begin: Head = { afterS: 0, done: 0 };
export const lessMotion = () => window.matchMedia("(prefers-reduced-motion: reduce)").matches;

export interface Scene {
  events: readonly SimulationEvent[];
  endS: number; // playing ends here
  stops: readonly number[]; // events at which it stops
}
export interface Shown {
  head: Head;
  stop: number; // the event of the breakpoint at which it stands; -1: at none
  over: boolean; // it has ended, there or at the end
}

// Plays on from a head, in ticks, until it is over or the function that it returns is called. Each tick goes on from the one
// before, and not from what is drawn, which comes later.
export function playOn(
  from: Head,
  { events, endS, stops }: Scene,
  speed: number,
  show: (shown: Shown) => void,
): () => void {
  let head = from;
  let nowS = from.afterS; // goes on where only whole events are shown
  let last = performance.now();
  const timer = setInterval(() => {
    const now = performance.now();
    nowS = Math.min(endS, nowS + ((now - last) / 1000) * speed);
    last = now;
    const next = advance(events, head, nowS, stops);
    head = next.head;
    const over = next.stop >= 0 || nowS >= endS;
    if (over) clearInterval(timer);
    show({ ...next, over });
  }, tickMs);
  return () => clearInterval(timer);
}

// Playing ends at `endS`; the head can be set up to `lengthS`.
export function usePlayer(
  events: readonly SimulationEvent[],
  { endS, lengthS }: { endS: number; lengthS: number },
  stops: readonly number[],
) {
  const [place, setPlace] = useState({ of: events, head: begin, stop: -1 });
  const [play, setPlay] = useState({ playing: false }); // another object: it begins again
  const [speed, setSpeed] = useState<number>(10);
  // With other events the head stays at its time.
  const kept = place.of === events;
  const head = kept
    ? place.head
    : place.head.done === 0
      ? begin
      : headAt(events, Math.min(place.head.afterS, lengthS));
  const latest = useRef({ head, events });
  latest.current = { head, events };
  const show = (to: Head, stop = -1) => setPlace({ of: latest.current.events, head: to, stop });
  const setPlaying = (playing: boolean) => setPlay({ playing });

  useEffect(() => {
    if (!play.playing) return;
    const from = latest.current.head;
    let done = from.done;
    return playOn(from, { events, endS, stops }, speed, ({ head, stop, over }) => {
      if (over || !lessMotion() || head.done !== done) setPlace({ of: events, head, stop });
      done = head.done;
      if (over) setPlaying(false);
    });
  }, [play, speed, events, endS, stops]);

  const go = (to: Head) => {
    setPlaying(false);
    show(to);
  };
  return {
    head,
    playing: play.playing,
    speed,
    setSpeed,
    stop: kept ? place.stop : -1,
    seek: (afterS: number) => go(headAt(events, afterS)),
    toEvent: (done: number) => go(headAfter(events, done)),
    play: () => (show(head.done >= events.length && head.afterS >= endS ? begin : head), setPlaying(true)),
    playFromBegin: () => (show(begin), setPlaying(true)),
    pause: () => setPlaying(false),
  };
}
export type Player = ReturnType<typeof usePlayer>;
