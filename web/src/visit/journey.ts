// How far a visitor's run is, and why it waits, as words to be said. Pure functions of what the server tells.
import { clockMinutes } from "../api/times";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import type { Run, Wait } from "../gen/docent/v1/workflows_pb";
import type { Word } from "./words";

const docent = "https://w3id.org/docent#";

export interface Sentence {
  word: Word;
  values?: Record<string, string | number>;
}
// What the page offers the visitor to do about a wait.
export type Remedy = "place" | "booth" | "here";
export interface Reason extends Sentence {
  remedy?: Remedy;
}
export type Phase =
  | "waiting"
  | "coming"
  | "here"
  | "ahead"
  | "guiding"
  | "presenting"
  | "working"
  | "staff"
  | "done"
  | "failed"
  | "cancelled";
export interface Journey {
  phase: Phase;
  robot: RobotStatus | undefined; // that works for the visitor
  reasons: Reason[];
}
export interface Visit {
  visitor: string; // IRIs
  at: string;
  booth: string;
  met: boolean; // the robot has been with the visitor in this run
}
export interface Naming {
  place: (iri: string) => string;
  robot: (iri: string) => string;
  property: (iri: string) => string;
  clock: (us: bigint) => string;
}

export function journeyOf(
  run: Run,
  waits: readonly Wait[],
  robots: readonly RobotStatus[],
  visit: Visit,
  naming: Naming,
): Journey {
  const robot = robotOf(run, robots);
  const reasons = unique(waits.flatMap((wait) => reasonsOf(wait, robots, visit, naming, run)));
  const as = (phase: Phase): Journey => ({ phase, robot, reasons });
  if (run.state === "done" || run.state === "failed" || run.state === "cancelled") return as(run.state);
  if (run.nodes.some((n) => n.state === "incident")) return as("staff");
  const works = run.nodes.some((n) => n.invocations.some((i) => i.state === "running" && i.robot !== ""));
  if (!robot) return as(works ? "working" : "waiting");
  const together = visit.at !== "" && robot.regions.includes(visit.at);
  if (!visit.met && !together) return as(works ? "coming" : "waiting");
  if (!works)
    return as(
      together ? "here" : visit.booth !== "" && robot.regions.includes(visit.booth) ? "ahead" : "waiting",
    );
  if (visit.booth !== "" && robot.regions.includes(visit.booth) && bothMove(run) && atTheBooth(run, visit))
    return as("presenting");
  return as(visit.booth !== "" && bothMove(run) ? "guiding" : together ? "here" : "working");
}

// After the first step: what came before was the way to the visitor.
function bothMove(run: Run): boolean {
  return run.nodes.some((n) => n.state === "done" && n.invocations.length > 0);
}

// By the page, or by what opened the step that is under way: somebody else, or a badge, may have told it. Until then the robot
// still leads there, also in its last metre.
function atTheBooth(run: Run, visit: Visit): boolean {
  const told = `<${visit.visitor}> <${docent}isAt> <${visit.booth}>`;
  return (
    visit.at === visit.booth || run.nodes.some((n) => n.state === "running" && n.firedBecause.includes(told))
  );
}

export function robotOf(run: Run, robots: readonly RobotStatus[]): RobotStatus | undefined {
  const busy = run.nodes.flatMap((n) => n.invocations).filter((i) => i.robot !== "");
  const iri = (busy.find((i) => i.state === "running") ?? busy.at(-1))?.robot;
  const held = robots.find((r) => r.heldBy === run.id);
  return robots.find((r) => r.robot === iri) ?? held;
}

// Words for one thing that a run waits for.
export function reasonsOf(
  wait: Wait,
  robots: readonly RobotStatus[],
  visit: Visit,
  naming: Naming,
  run?: Run,
): Reason[] {
  switch (wait.kind) {
    case "resume":
      return [{ word: "why.paused" }];
    case "operator":
      return [{ word: "why.staff" }];
    case "time":
      return wait.untilUs > 0n ? [{ word: "why.time", values: { time: naming.clock(wait.untilUs) } }] : [];
    case "robot":
      return whyNoRobot(
        robots.filter((r) => wait.robot === "" || r.robot === wait.robot),
        run,
      );
    case "fact":
      return wait.missing ? ofPatterns(wait.missing, robots, visit, naming, run) : pendingRobots(robots, run);
    default: // command, subflow, join: something is under way
      return [];
  }
}

function pendingRobots(robots: readonly RobotStatus[], run?: Run): Reason[] {
  return run?.nodes.some((n) => n.invocations.some((i) => i.state === "pending"))
    ? whyNoRobot(robots, run)
    : [];
}

interface Pattern {
  subject: string;
  property: string;
  object: string;
}
// "<s> <p> ?o . ?x <p> true ." with IRIs whole.
export function readPatterns(text: string): Pattern[] {
  const term = String.raw`(<[^>]*>|[?$]\w+|_:\w+|"(?:[^"\\]|\\.)*"(?:@[\w-]+|\^\^<[^>]*>)?|[^\s"<]+)`;
  return [...text.matchAll(new RegExp(`${term}\\s+${term}\\s+${term}\\s*(?:\\.|$)`, "g"))].map((m) => ({
    subject: bare(m[1]),
    property: bare(m[2]),
    object: bare(m[3]),
  }));
}
function bare(term = ""): string {
  return term.startsWith("<") ? term.slice(1, -1) : term;
}

function ofPatterns(
  text: string,
  robots: readonly RobotStatus[],
  visit: Visit,
  naming: Naming,
  run?: Run,
): Reason[] {
  return readPatterns(text).flatMap(({ subject, property, object }): Reason[] => {
    const named = naming.place(object);
    if (subject === visit.visitor && property === `${docent}isAt`) {
      const there = visit.booth !== "" && object !== "" && !/^[?$]/.test(object);
      return there && named !== ""
        ? [{ word: "why.follow", values: { place: named }, remedy: "here" }]
        : [{ word: "why.place", remedy: "place" }];
    }
    if (subject === visit.visitor && property === `${docent}selected`)
      return [{ word: "why.booth", remedy: "booth" }];
    const ofRobot = robots.filter((r) => r.robot === subject || /^[?$]/.test(subject));
    if (property === `${docent}isAt` && ofRobot[0] && named !== "")
      return [{ word: "why.robotThere", values: { robot: naming.robot(ofRobot[0].robot), place: named } }];
    if (
      property === `${docent}status` ||
      property === `${docent}localised` ||
      object === `${docent}AvailableRobot`
    ) {
      const why = whyNoRobot(ofRobot.length > 0 ? ofRobot : robots, run);
      return why.length > 0 || property !== `${docent}localised`
        ? why
        : ofRobot.slice(0, 1).map((r) => ({ word: "why.lost", values: { robot: naming.robot(r.robot) } }));
    }
    const words = [
      naming.robot(subject) || naming.place(subject) || local(subject),
      naming.property(property) || local(property),
      naming.robot(object) || named || local(object),
    ];
    return [{ word: "why.other", values: { fact: words.join(" ") } }];
  });
}
function local(term: string): string {
  if (/^[?$]/.test(term)) return "…";
  const literal = /^"([\s\S]*)"(?:@[\w-]+|\^\^\S+)?$/.exec(term);
  return literal ? (literal[1] ?? "").replace(/\\(.)/g, "$1") : term.replace(/^.*[#/]/, "");
}

// Why none of the robots is on its way: the nearest to being free first.
export function whyNoRobot(robots: readonly RobotStatus[], run?: Run): Reason[] {
  if (robots.length === 0) return [{ word: "why.noRobot" }];
  const order: Word[] = [
    "why.ending",
    "why.busy",
    "why.lost",
    "why.charging",
    "why.maintenance",
    "why.out",
    "why.outReason",
    "why.offlineSince",
    "why.offline",
  ];
  return robots
    .flatMap((r) => whyNot(r, run))
    .sort((a, b) => order.indexOf(a.word) - order.indexOf(b.word))
    .slice(0, 4);
}
function whyNot(r: RobotStatus, run?: Run): Reason[] {
  const robot = r.label || r.robot.replace(/^.*[#/]/, "");
  if (r.outOfService)
    return [
      r.outOfServiceReason
        ? { word: "why.outReason", values: { robot, reason: r.outOfServiceReason } }
        : { word: "why.out", values: { robot } },
    ];
  if (r.state === "offline")
    return [
      r.lastSeenUs > 0n
        ? { word: "why.offlineSince", values: { robot, time: clockOf(r.lastSeenUs) } }
        : { word: "why.offline", values: { robot } },
    ];
  if (r.state === "charging") return [{ word: "why.charging", values: { robot } }];
  if (r.state === "maintenance") return [{ word: "why.maintenance", values: { robot } }];
  if (r.endingCommands.length > 0) return [{ word: "why.ending", values: { robot } }];
  if (r.heldBy !== "" && r.heldBy !== run?.id) return [{ word: "why.busy", values: { robot } }];
  if (r.state === "busy" && r.heldBy === "") return [{ word: "why.ending", values: { robot } }];
  if (!r.hasPose) return [{ word: "why.lost", values: { robot } }];
  return [];
}
export function clockOf(us: bigint): string {
  return clockMinutes(us);
}

function unique(reasons: Reason[]): Reason[] {
  const seen = new Set<string>();
  return reasons.filter((r) => {
    const key = `${r.word} ${JSON.stringify(r.values ?? {})}`;
    return !seen.has(key) && seen.add(key);
  });
}
