// Runs that steps of another run have started: how far they are, and whether they wait. Pure functions.
import type { Invocation, Run } from "../gen/docent/v1/workflows_pb";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { words } from "../cawl/names";
import { reasonWords } from "./reason_words";
import { clock, isLive } from "../ui/states";

const deepest = 8;

// The run that an invocation of a sub-flow has started; the newest, where it was tried again.
export function innerRun(run: Run, invocation: Invocation, runs: readonly Run[]): Run | undefined {
  const mine = runs.filter(
    (r) =>
      r.parent === run.id && [r.workflow, r.flow, `${r.workflow}/${r.flow}`].includes(invocation.operation),
  );
  return mine.filter((r) => isLive(r.state)).at(-1) ?? mine.at(-1);
}

// 0 to 1: what the robots say; of a sub-flow, the part of its steps that are done.
export function progressOf(run: Run, invocation: Invocation, runs: readonly Run[], depth = 0): number {
  const inner = depth < deepest ? innerRun(run, invocation, runs) : undefined;
  if (!inner) return invocation.progress;
  const steps = inner.nodes.filter((n) => n.state !== "skipped");
  const done = steps.map((n) =>
    n.state === "done"
      ? 1
      : n.invocations.length > 0
        ? n.invocations.reduce((sum, i) => sum + progressOf(inner, i, runs, depth + 1), 0) /
          n.invocations.length
        : 0,
  );
  return steps.length > 0 ? done.reduce((sum, part) => sum + part, 0) / steps.length : invocation.progress;
}

// "running", and "waiting", "paused" or "incident" where that says more: also where only its inner runs wait.
export function stateOf(run: Run, runs: readonly Run[] = [], depth = 0): string {
  if (run.state !== "running") return run.state;
  if (run.nodes.some((n) => n.state === "incident")) return "incident";
  if (run.paused) return "paused";
  const active = run.nodes.filter((n) => n.state === "running");
  if (active.length === 0) return run.nodes.some((n) => n.state === "waiting") ? "waiting" : "running";
  const under = active.flatMap((n) =>
    n.invocations
      .filter((i) => i.state === "running")
      .map((i) => (depth < deepest ? innerRun(run, i, runs) : undefined)),
  );
  const states = new Set(under.map((inner) => (inner ? stateOf(inner, runs, depth + 1) : "running")));
  const [only] = states;
  return states.size === 1 && only && ["waiting", "paused", "incident"].includes(only) ? only : "running";
}

// What a run does or waits for, in a line; of a run within it, what that does.
export function whereWords(run: Run, runs: readonly Run[] = [], depth = 0): string {
  if (run.reason) return reasonWords(run.reason).words;
  const busy = run.nodes.filter((n) => ["running", "incident"].includes(n.state));
  if (busy.length > 0)
    return busy
      .map((n) => {
        const i = n.invocations.find((x) => ["running", "pending"].includes(x.state));
        if (!i) return n.name;
        const inner = i.state === "running" && depth < deepest ? innerRun(run, i, runs) : undefined;
        const within = inner && isLive(inner.state) ? whereWords(inner, runs, depth + 1) : "";
        const what = i.state === "pending" ? "waits for a robot" : within || words(i.operation);
        return `${n.name}: ${what}${!within && i.progress > 0 && i.progress < 1 ? ` ${Math.round(i.progress * 100)} %` : ""}`;
      })
      .join(", ");
  const waiting = run.nodes.filter((n) => n.state === "waiting");
  return waiting.length > 0 ? `${waiting.map((n) => n.name).join(", ")} waits` : "";
}
export type Lost = Pick<RobotStatus, "robot" | "label" | "lastSeenUs" | "heldBy" | "heldFor">;

// Of robots that are offline: those that a live run has something under way with.
export function lostOf(run: Run, offline: readonly Lost[]): readonly Lost[] {
  if (!isLive(run.state) || offline.length === 0) return [];
  const busy = new Set(
    run.nodes
      .filter((n) => n.state === "running")
      .flatMap((n) => n.invocations.filter((i) => i.state === "running").map((i) => i.robot)),
  );
  return offline.filter(
    (r) =>
      busy.has(r.robot) ||
      r.heldFor.some((task) => task.run === run.id) ||
      (r.heldBy === run.id && r.heldFor.length > 0),
  );
}
// " since 18:20:03"
export function sinceWords(robot: Pick<RobotStatus, "lastSeenUs">): string {
  return robot.lastSeenUs > 0n ? ` since ${clock(robot.lastSeenUs)}` : "";
}

export interface UnderWay {
  robot: string; // IRI
  node: string;
  operation: string;
}
// What robots do for a run now, in runs within it, too: those that have a command. One that was stopped by a pause has none.
export function underWay(run: Run, runs: readonly Run[] = [], depth = 0): UnderWay[] {
  if (!isLive(run.state)) return [];
  return run.nodes.flatMap((n) =>
    n.invocations
      .filter((i) => i.state === "running")
      .flatMap((i): UnderWay[] => {
        const inner = i.robot === "" && depth < deepest ? innerRun(run, i, runs) : undefined;
        return inner
          ? underWay(inner, runs, depth + 1)
          : i.robot && i.command
            ? [{ robot: i.robot, node: n.name, operation: i.operation }]
            : [];
      }),
  );
}
