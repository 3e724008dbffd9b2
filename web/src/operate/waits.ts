// What all live runs wait for, grouped by what lacks, the oldest first: from what the server explains of each run. Pure functions.
import type { Names } from "../api/prefixes";
import type { Node, Run, Wait } from "../gen/docent/v1/workflows_pb";
import { isLive } from "./states";

export type WaitKind = "operator" | "fact" | "robot" | "time" | "resume";
export interface Waiting {
  run: Run; // that has the node: maybe a sub-flow
  node: Node | undefined; // undefined: the run as a whole
  root: Run;
  sinceUs: bigint;
}
export interface Group {
  key: string;
  kind: WaitKind;
  title: string[]; // facts, or words
  heldBy: string; // run that has the robot
  waiting: Waiting[];
  oldestUs: bigint;
  ask: string; // the condition, for what would make it hold; empty: there is none
}
// Command, subflow, join: something is under way, and ends by itself.
const shown: readonly string[] = ["operator", "fact", "robot", "time", "resume"] satisfies WaitKind[];

// "<s> <p> ?o . <s2> …" as patterns with prefixes, one a fact.
export function factsOf(missing: string, names: Pick<Names, "short">): string[] {
  const short = missing.replace(/<([^>]+)>/g, (whole, iri: string) => names.short(iri) || whole);
  return short.split(/\s\.(?:\s+|$)/).map((fact) => fact.trim()).filter(Boolean);
}

export function groupWaits(runs: readonly Run[], waits: ReadonlyMap<string, readonly Wait[]>, names: Pick<Names, "short" | "name">, clock: (us: bigint) => string): Group[] {
  const byId = new Map(runs.map((run) => [run.id, run]));
  const groups = new Map<string, Group>();
  for (const root of runs.filter((r) => !r.parent && isLive(r.state))) {
    for (const { kind, title, heldBy, place } of gathered(waits.get(root.id) ?? [], names, clock)) {
      const { run, node } = placeOf(place, root, byId);
      const sinceUs = node?.sinceUs || run.startedUs;
      const key = JSON.stringify([kind, title]);
      const group = groups.get(key) ?? { key, kind, title, heldBy, waiting: [], oldestUs: sinceUs, ask: "" };
      group.waiting.push({ run, node, root, sinceUs });
      if (sinceUs < group.oldestUs) group.oldestUs = sinceUs;
      if (kind === "fact" && node?.waitsFor && !group.ask) group.ask = node.waitsFor.split("\n# or\n")[0] ?? "";
      groups.set(key, group);
    }
  }
  for (const group of groups.values()) group.waiting.sort((a, b) => Number(a.sinceUs - b.sinceUs));
  // What somebody has to decide comes first.
  return [...groups.values()].sort((a, b) => Number(b.kind === "operator") - Number(a.kind === "operator") || Number(a.oldestUs - b.oldestUs));
}

interface Gathered {
  kind: WaitKind;
  title: string[];
  heldBy: string;
  place: string;
}
// Of one run: the robots that a node waits for are one thing, since any of them will do.
function gathered(waits: readonly Wait[], names: Pick<Names, "short" | "name">, clock: (us: bigint) => string): Gathered[] {
  const found: Gathered[] = [];
  for (const wait of waits.filter((w) => shown.includes(w.kind))) {
    const kind = wait.kind as WaitKind;
    const same = kind === "robot" ? found.find((g) => g.kind === "robot" && g.place === wait.node) : undefined;
    const title = titleOf(wait, kind, names, clock);
    if (!same) found.push({ kind, title, heldBy: wait.heldBy, place: wait.node });
    else if (!same.title.includes(title[0] ?? "")) same.title.push(...title);
  }
  return found;
}
function titleOf(wait: Wait, kind: WaitKind, names: Pick<Names, "short" | "name">, clock: (us: bigint) => string): string[] {
  const plain = wait.detail.replace(/<([^>]+)>/g, (_, iri: string) => names.name(iri));
  if (kind === "fact" && wait.missing) return factsOf(wait.missing, names);
  if (kind === "robot" && wait.robot) return [names.name(wait.robot)];
  if (kind === "time" && wait.untilUs > 0n) return [`until ${clock(wait.untilUs)}`];
  if (kind === "operator") return [plain.replace(/^it failed: /, "").replace(/; settle it:[\s\S]*$/, "")];
  return [plain.replace(/; docent runs[\s\S]*$/, "")];
}

// "Move2User" of the run itself, or "BoothGuide-2/Move2User" of a sub-flow.
function placeOf(place: string, root: Run, byId: ReadonlyMap<string, Run>): { run: Run; node: Node | undefined } {
  const own = root.nodes.find((n) => n.name === place);
  if (own || place === "") return { run: root, node: own };
  const slash = place.indexOf("/");
  const run = byId.get(place.slice(0, slash));
  return run ? { run, node: run.nodes.find((n) => n.name === place.slice(slash + 1)) } : { run: root, node: undefined };
}
