// What all live runs wait for, grouped by what lacks, the oldest first: from what the server explains of each run. Pure functions.
import { replaceIris, splitFacts } from "../api/iris";
import type { Names } from "../api/prefixes";
import type { Node, Run, Wait } from "../gen/docent/v1/workflows_pb";
import { asMeant, factsOf, factWords } from "../facts/fact_words";
import {
  awayWords,
  type Cause,
  causeOf,
  isAway,
  isOfRobot,
  isOwnFact,
  type Known,
  noCause,
  tellsItself,
} from "../facts/no_robot";
import { reasonWords } from "./reason_words";
import { sinceWords } from "./runs_within";
import { isLive, runWords } from "../ui/states";

export type WaitKind = "operator" | "lost" | "fact" | "robot" | "time" | "resume";
export interface Waiting {
  run: Run; // that has the node: maybe a sub-flow
  node: Node | undefined; // undefined: the run as a whole
  root: Run;
  sinceUs: bigint;
}
export interface Group {
  key: string;
  kind: WaitKind;
  title: string[]; // facts as patterns, or words
  detail: string; // as the server said it, where the title says it otherwise
  noRobot: string; // why no robot can begin it; empty: it is not known that none can
  robots: readonly string[]; // IRIs of robots that are the cause
  heldBy: string; // run that has the robot
  waiting: Waiting[];
  oldestUs: bigint;
  ask: string; // the condition, for what would make it hold; empty: there is none, or only robots can tell what lacks
}
// Command, subflow, join: something is under way, and ends by itself; a command of a robot that is offline does not.
const shown: readonly string[] = ["operator", "fact", "robot", "time", "resume"] satisfies WaitKind[];

export function groupWaits(
  runs: readonly Run[],
  waits: ReadonlyMap<string, readonly Wait[]>,
  names: Pick<Names, "short" | "name">,
  clock: (us: bigint) => string,
  robots: readonly Known[] = [],
): Group[] {
  const byId = new Map(runs.map((run) => [run.id, run]));
  const groups = new Map<string, Group>();
  for (const root of runs.filter((r) => !r.parent && isLive(r.state))) {
    for (const { kind, title, heldBy, place, detail, cause, told, ask } of gathered(
      root,
      waits.get(root.id) ?? [],
      byId,
      names,
      clock,
      robots,
    )) {
      const { run, node } = placeOf(place, root, byId);
      const sinceUs = node?.sinceUs || run.startedUs;
      const key = JSON.stringify([kind, title, cause.words]);
      const group = groups.get(key) ?? {
        key,
        kind,
        title,
        detail,
        noRobot: cause.words,
        robots: cause.robots,
        heldBy,
        waiting: [],
        oldestUs: sinceUs,
        ask: "",
      };
      group.waiting.push({ run, node, root, sinceUs });
      if (sinceUs < group.oldestUs) group.oldestUs = sinceUs;
      if (told && !group.ask) group.ask = ask;
      groups.set(key, group);
    }
  }
  for (const group of groups.values()) group.waiting.sort((a, b) => Number(a.sinceUs - b.sinceUs));
  // What somebody has to decide comes first.
  return [...groups.values()].sort(
    (a, b) =>
      Number(b.kind === "operator") - Number(a.kind === "operator") || Number(a.oldestUs - b.oldestUs),
  );
}

interface Gathered {
  kind: WaitKind;
  title: string[];
  detail: string;
  cause: Cause;
  heldBy: string;
  place: string;
  told: boolean; // something of it can be told by people
  ask: string; // the condition that lacks it; empty: it is not known which
}
// The conditions of a node, any of which opens it.
export function alternativesOf(waitsFor: string): string[] {
  return waitsFor === "" ? [] : waitsFor.split("\n# or\n");
}
// Each alternative is told by one wait, or by one for each robot with which it holds.
function askOf(wait: Wait, waits: readonly Wait[], node: Node | undefined): string {
  const asks = alternativesOf(node?.waitsFor ?? "");
  const ofNode = waits.filter((w) => w.node === wait.node);
  return asks[asks.length === ofNode.length ? ofNode.indexOf(wait) : asks.length === 1 ? 0 : -1] ?? "";
}
// Of one run: the robots that a node waits for are one thing, since any of them will do.
function gathered(
  root: Run,
  waits: readonly Wait[],
  byId: ReadonlyMap<string, Run>,
  names: Pick<Names, "short" | "name">,
  clock: (us: bigint) => string,
  robots: readonly Known[],
): Gathered[] {
  const found: Gathered[] = [];
  for (const wait of waits) {
    const at = { detail: "", cause: noCause, heldBy: wait.heldBy, place: wait.node, told: false, ask: "" };
    const lost =
      wait.kind === "command"
        ? robots.find((r) => r.robot === wait.robot && r.state === "offline")
        : undefined;
    if (lost)
      found.push({
        ...at,
        kind: "lost",
        title: [`${lost.label || names.name(lost.robot)} is offline${sinceWords(lost)}`],
        cause: { words: "", robots: [lost.robot] },
      });
    if (!shown.includes(wait.kind)) continue;
    const kind = wait.kind as WaitKind;
    if (kind === "fact" && wait.missing) {
      const place = placeOf(wait.node, root, byId);
      const ask = askOf(wait, waits, place.node);
      found.push({ ...at, ask, ...ofFacts(wait.missing, ask, place, names, robots) });
      continue;
    }
    const same =
      kind === "robot" ? found.find((g) => g.kind === "robot" && g.place === wait.node) : undefined;
    const { words, detail } = titleOf(wait, kind, names, clock, robots);
    const robot = kind === "robot" && wait.robot ? [wait.robot] : [];
    if (!same) found.push({ ...at, kind, title: [words], detail, cause: { words: "", robots: robot } });
    else if (!same.title.includes(words))
      Object.assign(same, {
        title: [...same.title, words],
        cause: { words: "", robots: [...same.cause.robots, ...robot] },
      });
  }
  return found;
}
// What robots tell of themselves is not for people to tell: said is why no robot is ready, or that the one of the run is away.
function ofFacts(
  missing: string,
  ask: string,
  { run }: { run: Run },
  names: Pick<Names, "short">,
  robots: readonly Known[],
): Pick<Gathered, "kind" | "title" | "cause" | "told"> {
  const facts = splitFacts(missing).map((text) => {
    const [, subject = "", property = ""] = /^<([^>]*)>\s+<([^>]*)>/.exec(text) ?? [];
    return {
      subject,
      own: isOwnFact(subject, property, robots),
      ofRobot: isOfRobot(subject, property, robots),
      words: factsOf(text, names)[0] ?? text,
    };
  });
  const blamed = facts.filter((f) => f.ofRobot);
  // A robot that the run has is the one that is waited for; else any would do.
  const bound = run.variables.some(
    (v) => v.value?.kind.case === "iri" && blamed.some((f) => f.subject === (v.value?.kind.value as string)),
  );
  const cause =
    blamed.length === 0
      ? noCause
      : causeOf(
          robots.filter((r) => tellsItself(r) && (!bound || blamed.some((f) => f.subject === r.robot))),
          run.id,
          bound,
        );
  const rest = cause.words === "" ? facts : facts.filter((f) => !f.ofRobot);
  return {
    kind: rest.length === 0 ? "robot" : "fact",
    title: rest.map((f) => asMeant(f.words, ask)),
    cause,
    told: facts.some((f) => !f.own),
  };
}
function titleOf(
  wait: Wait,
  kind: WaitKind,
  names: Pick<Names, "short" | "name">,
  clock: (us: bigint) => string,
  robots: readonly Known[],
): { words: string; detail: string } {
  const plain = replaceIris(wait.detail, names.name);
  const as = (words: string) => ({ words, detail: "" });
  const away = robots.find((r) => r.robot === wait.robot && isAway(r));
  if (kind === "robot" && wait.robot)
    return as(`${names.name(wait.robot)}${away ? ` (${awayWords(away)})` : ""}`);
  if (kind === "time" && wait.untilUs > 0n) return as(`until ${clock(wait.untilUs)}`);
  if (kind === "operator")
    return reasonWords(plain.replace(/^it failed: /, "").replace(/; settle it:[\s\S]*$/, ""));
  return as(plain.replace(/; docent runs[\s\S]*$/, ""));
}

// What a group waits for, as a part of a sentence, for lists of runs.
export function waitsWords(
  group: Pick<Group, "kind" | "title" | "noRobot" | "heldBy">,
  prefixes: ReadonlyMap<string, string>,
): string {
  const facts = group.title.map((t) => factWords(t, prefixes)).join(" and ");
  switch (group.kind) {
    case "fact":
      return [group.noRobot, facts && `it is not known yet: ${facts}`].filter(Boolean).join("; ");
    case "robot":
      return (
        group.noRobot ||
        `needs ${group.title.join(" or ")}${group.heldBy ? `, which ${runWords(group.heldBy)} has` : ""}`
      );
    case "lost":
      return `${group.title[0]}; nothing more is heard of its step until it is back`;
    case "operator":
      return `${group.title[0]}: somebody has to decide`;
    case "resume":
      return "";
    default:
      return group.title.join(", ");
  }
}

// "Move2User" of the run itself, or "BoothGuide-2/Move2User" of a sub-flow.
function placeOf(
  place: string,
  root: Run,
  byId: ReadonlyMap<string, Run>,
): { run: Run; node: Node | undefined } {
  const own = root.nodes.find((n) => n.name === place);
  if (own || place === "") return { run: root, node: own };
  const slash = place.indexOf("/");
  const run = byId.get(place.slice(0, slash));
  return run
    ? { run, node: run.nodes.find((n) => n.name === place.slice(slash + 1)) }
    : { run: root, node: undefined };
}
