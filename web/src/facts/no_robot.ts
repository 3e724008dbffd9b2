// Facts that robots tell of themselves, and why none of them is ready, for the staff. Pure functions.
import { clock, runWords } from "../ui/states";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";

const docent = "https://w3id.org/docent#";
const own = new Set(
  [
    "status",
    "localised",
    "isAt",
    "x",
    "y",
    "heading",
    "positionDeviation",
    "plannedPath",
    "currentCommand",
    "progress",
    "battery",
    "screenPage",
    "spokenFile",
    "offers",
    "adapterAddress",
    "incarnation",
  ].map((name) => docent + name),
);
// That say whether the robot can begin something.
const readiness = new Set(["status", "localised"].map((name) => docent + name));

export type Known = Pick<
  RobotStatus,
  | "robot"
  | "label"
  | "state"
  | "address"
  | "lastSeenUs"
  | "heldBy"
  | "endingCommands"
  | "outOfService"
  | "outOfServiceReason"
  | "hasPose"
>;

// It has an adapter, or had one. Only the adapter knows how such a robot is. A robot that people play has no adapter and is never offline.
export function tellsItself(robot: Known | undefined): boolean {
  return robot !== undefined && (robot.address !== "" || robot.state === "offline");
}
export function isOwnFact(subject: string, property: string, robots: readonly Known[]): boolean {
  return own.has(property) && tellsItself(robots.find((r) => r.robot === subject));
}
// It tells nothing, or gets no command, whatever it tells.
export function isAway(robot: Pick<Known, "state" | "outOfService">): boolean {
  return robot.outOfService || robot.state === "offline";
}
// "out of service: a wheel is loose", of a robot whose name is said already.
export function awayWords(
  r: Pick<Known, "state" | "outOfService" | "outOfServiceReason" | "lastSeenUs">,
): string {
  const offline = `offline${r.lastSeenUs > 0n ? ` since ${clock(r.lastSeenUs)}` : ""}`;
  if (!r.outOfService) return offline;
  return `out of service${r.outOfServiceReason ? `: ${r.outOfServiceReason}` : ""}${r.state === "offline" ? `, and ${offline}` : ""}`;
}
// Whether the fact lacks because of how its robot is: then that is the cause, and not the fact.
export function isOfRobot(subject: string, property: string, robots: readonly Known[]): boolean {
  const robot = robots.find((r) => r.robot === subject);
  return (
    isOwnFact(subject, property, robots) &&
    (readiness.has(property) || (robot !== undefined && isAway(robot)))
  );
}

// Why the robot can't begin; empty: nothing is known against it.
export function whyNotReady(r: Known, run = ""): string {
  const name = r.label || r.robot.replace(/^.*[#/]/, "");
  if (isAway(r))
    return `${name} is ${awayWords(r)}${r.outOfService || r.lastSeenUs > 0n ? "" : ": its adapter has not joined"}`;
  if (r.state === "charging") return `${name} is charging`;
  if (r.state === "maintenance") return `${name} is in maintenance`;
  if (r.endingCommands.length > 0) return `${name} still ends a command`;
  if (r.heldBy !== "" && r.heldBy !== run) return `${name} works for ${runWords(r.heldBy)}`;
  if (r.state === "busy") return `${name} is busy`;
  return r.hasPose ? "" : `${name} does not know where it is`;
}

// Why robots that would do can't begin.
export interface Cause {
  words: string; // empty: nothing is known against them
  robots: readonly string[]; // IRIs of those that are named, for what can be done about it
}
const shown = 4;
// `only`: the run has this robot, and waits for no other. Else those that are nearest to being free come first.
export function causeOf(robots: readonly Known[], run = "", only = false): Cause {
  const order = (r: Known) =>
    r.outOfService
      ? 4
      : ["busy", "standby"].includes(r.state)
        ? 0
        : r.state === "charging"
          ? 1
          : r.state === "maintenance"
            ? 2
            : 3;
  const why = [...robots]
    .sort((a, b) => order(a) - order(b))
    .map((r) => ({ robot: r.robot, words: whyNotReady(r, run) }))
    .filter((w) => w.words !== "");
  const first = why.slice(0, shown);
  const words = `${first.map((w) => w.words).join("; ")}${why.length > shown ? `; and ${why.length - shown} more` : ""}`;
  return {
    words: why.length === 0 ? "" : only ? words : `No robot can come: ${words}`,
    robots: first.map((w) => w.robot),
  };
}
export const noCause: Cause = { words: "", robots: [] };
