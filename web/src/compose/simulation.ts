// A simulation as events in time: what the canvas shows at a moment, where breakpoints stop, where robots are. Pure functions.
import type { Step } from "../cawl/document";
import type { SimulatedPose, SimulatedStep, SimulateReply } from "../gen/docent/v1/replays_pb";
import type { Quad } from "../gen/docent/v1/term_pb";
import type { StepTrial } from "./trials";

export interface Telling {
  afterS: number;
  quad: Quad;
  remove: boolean; // the fact stands in the way, and goes
}
export type SimulationEvent =
  | { afterS: number; step: SimulatedStep; telling?: undefined }
  | { afterS: number; telling: Telling; step?: undefined };
// The moment that is shown. Several events may have the same time: the first `done` ones have happened.
export interface Head {
  afterS: number;
  done: number;
}

const waitingS = 30;
const ended = ["done", "failed", "cancelled"];
export const hasEnded = (reply: SimulateReply) => ended.includes(reply.state);

export const inOrder = (told: readonly Telling[]) => [...told].sort((a, b) => a.afterS - b.afterS);

// A telling is a turn of its own, after the one that the simulation begins with: steps of that turn follow from it.
export function eventsOf(reply: SimulateReply, told: readonly Telling[]): SimulationEvent[] {
  const events: SimulationEvent[] = [];
  const tellings = inOrder(told);
  let next = 0;
  for (const step of reply.steps) {
    while (next < tellings.length && (step.step?.turn ?? 0n) > reply.turn + BigInt(next)) {
      const telling = tellings[next++];
      if (telling) events.push({ afterS: telling.afterS, telling });
    }
    events.push({ afterS: step.afterS, step });
  }
  return [...events, ...tellings.slice(next).map((telling) => ({ afterS: telling.afterS, telling }))];
}

// When the last thing happens, and how far the clock can be set: a run that ends waiting goes on waiting.
export function endOf(
  reply: SimulateReply,
  events: readonly SimulationEvent[],
): { endS: number; lengthS: number } {
  const endS = Math.max(0, reply.endedS, events.at(-1)?.afterS ?? 0, reply.poses.at(-1)?.afterS ?? 0);
  return { endS, lengthS: hasEnded(reply) ? endS : endS + waitingS };
}

export function headAt(events: readonly SimulationEvent[], afterS: number): Head {
  const next = events.findIndex((e) => e.afterS > afterS);
  return { afterS, done: next < 0 ? events.length : next };
}
export function headAfter(events: readonly SimulationEvent[], done: number): Head {
  const within = Math.max(0, Math.min(events.length, done));
  return { afterS: events[within - 1]?.afterS ?? 0, done: within };
}

// Steps of the flow itself by name, as they are at this moment.
export function statesAt(
  events: readonly SimulationEvent[],
  done: number,
  steps: readonly Pick<Step, "name" | "kind">[],
): Map<string, StepTrial> {
  const states = new Map<string, string>();
  let run = "";
  for (const { step } of events.slice(0, done)) {
    const state = step?.step?.state;
    if (!step || !state) continue;
    if (step.node === "") run = state;
    else states.set(step.node, state);
  }
  return new Map(
    steps.map((s): [string, StepTrial] => {
      const own =
        s.kind === "source"
          ? run === ""
            ? "inactive"
            : "done"
          : s.kind === "sink"
            ? run === "done"
              ? "done"
              : "inactive"
            : (states.get(s.name) ?? "inactive");
      return [s.name, { state: own, differs: false }];
    }),
  );
}

// Events at which playing stops: where a step with a breakpoint opens, or if it never does, where it comes to wait.
export function stopsOf(events: readonly SimulationEvent[], breakpoints: ReadonlySet<string>): number[] {
  const into = (name: string, state: string) =>
    events.flatMap((e, i) => (e.step?.node === name && e.step.step?.state === state ? [i] : []));
  return [...breakpoints]
    .flatMap((name) => {
      const opens = into(name, "running");
      return opens.length > 0 ? opens : into(name, "waiting").slice(0, 1);
    })
    .sort((a, b) => a - b);
}

// The head moves on to a time, or to a breakpoint before it. `stop`: the event of that breakpoint; -1: none.
export function advance(
  events: readonly SimulationEvent[],
  head: Head,
  toS: number,
  stops: readonly number[],
): { head: Head; stop: number } {
  const to = headAt(events, toS);
  const stop = stops.find((i) => i >= head.done && i < to.done);
  return stop === undefined ? { head: to, stop: -1 } : { head: headAfter(events, stop + 1), stop };
}

// What a step sends next: its commands before it comes into another state.
export function commandsAfter(
  events: readonly SimulationEvent[],
  done: number,
  node: string,
): SimulatedStep[] {
  const own = events.slice(done).flatMap(({ step }) => (step?.node === node ? [step] : []));
  const next = own.findIndex((s) => s.step?.state);
  return (next < 0 ? own : own.slice(0, next)).filter((s) => s.step?.operation);
}

// Values that the conditions of steps have found up to this moment: "robot" → "<https://…#R01>".
export function valuesAt(events: readonly SimulationEvent[], done: number): Map<string, string> {
  const values = new Map<string, string>();
  for (const { step } of events.slice(0, done)) {
    const found = / holds with ([\s\S]*)$/.exec(step?.step?.cause ?? "")?.[1] ?? "";
    for (const match of found.matchAll(/(\w+) = (<[^>]*>|"(?:[^"\\]|\\.)*"[^\s,]*|[^\s,]+)(?:, |$)/g))
      values.set(match[1] ?? "", match[2] ?? "");
  }
  return values;
}

export interface Place {
  x: number;
  y: number;
  heading: number;
  driving: boolean;
}
const poseEveryS = 1.5; // poses of one drive are nearer to each other
// Where robots that drive in the simulation are: between two poses on the line, before the first one there.
export function placesAt(poses: readonly SimulatedPose[], afterS: number): Map<string, Place> {
  const places = new Map<string, Place>();
  for (const robot of new Set(poses.map((p) => p.robot))) {
    const own = poses.filter((p) => p.robot === robot);
    const at = own.findLastIndex((p) => p.afterS <= afterS);
    const before = own[Math.max(0, at)];
    if (!before) continue;
    const next = own[at + 1];
    const driving = at >= 0 && next !== undefined && next.afterS - before.afterS <= poseEveryS;
    const along = driving ? (afterS - before.afterS) / (next.afterS - before.afterS || 1) : 0;
    const from = driving ? before : (own[at - 1] ?? before);
    const to = driving ? next : before;
    const heading = from === to ? 0 : Math.atan2(to.y - from.y, to.x - from.x);
    places.set(robot, {
      x: before.x + along * ((next?.x ?? 0) - before.x),
      y: before.y + along * ((next?.y ?? 0) - before.y),
      heading,
      driving,
    });
  }
  return places;
}
