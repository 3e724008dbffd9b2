// The playhead of a simulation: it plays at a speed, stops at breakpoints, and goes from event to event.
import { useEffect, useRef, useState } from "react";
import { advance, headAfter, headAt, type Head, type SimulationEvent } from "./simulation";

export const speeds = [1, 10, 60] as const;
const tickMs = 100;
const begin: Head = { afterS: 0, done: 0 };
export const lessMotion = () => window.matchMedia("(prefers-reduced-motion: reduce)").matches;

// Playing ends at `endS`; the head can be set up to `lengthS`.
export function usePlayer(events: readonly SimulationEvent[], { endS, lengthS }: { endS: number; lengthS: number }, stops: readonly number[]) {
  const [place, setPlace] = useState({ of: events, head: begin, stop: -1 });
  const [playing, setPlaying] = useState(false);
  const [speed, setSpeed] = useState<number>(10);
  // With other events the head stays at its time.
  const kept = place.of === events;
  const head = kept ? place.head : place.head.done === 0 ? begin : headAt(events, Math.min(place.head.afterS, lengthS));
  const latest = useRef({ head, events, endS, stops });
  latest.current = { head, events, endS, stops };
  const show = (to: Head, stop = -1) => setPlace({ of: latest.current.events, head: to, stop });

  useEffect(() => {
    if (!playing) return;
    let last = performance.now();
    let nowS = latest.current.head.afterS; // goes on where only whole events are shown
    const timer = window.setInterval(() => {
      const now = performance.now();
      const { head, events, endS, stops } = latest.current;
      nowS = Math.min(endS, nowS + ((now - last) / 1000) * speed);
      last = now;
      const next = advance(events, head, nowS, stops);
      const over = next.stop < 0 && nowS >= endS;
      if (over || !lessMotion() || next.head.done !== head.done) show(next.head, next.stop);
      if (over || next.stop >= 0) setPlaying(false);
    }, tickMs);
    return () => window.clearInterval(timer);
  }, [playing, speed]);

  const go = (to: Head) => {
    setPlaying(false);
    show(to);
  };
  return {
    head, playing, speed, setSpeed,
    stop: kept ? place.stop : -1, // the event of the breakpoint at which it stands; -1: at none
    seek: (afterS: number) => go(headAt(events, afterS)),
    toEvent: (done: number) => go(headAfter(events, done)),
    play: () => (show(head.done >= events.length && head.afterS >= endS ? begin : head), setPlaying(true)),
    playFromBegin: () => (show(begin), setPlaying(true)),
    pause: () => setPlaying(false),
  };
}
export type Player = ReturnType<typeof usePlayer>;
