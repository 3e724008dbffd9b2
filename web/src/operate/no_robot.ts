// Facts that robots tell of themselves, and why none of them is ready, for the staff. Pure functions.
import { clock, runWords } from "./states";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";

const docent = "https://w3id.org/docent#";
const own = new Set(["status", "localised", "isAt", "x", "y", "heading", "positionDeviation", "plannedPath", "currentCommand", "progress", "batteryLevel", "offers", "hasCapability", "adapterAddress", "incarnation"].map((name) => docent + name));
// That say whether the robot can begin something.
const readiness = new Set(["status", "localised"].map((name) => docent + name));

export type Known = Pick<RobotStatus, "robot" | "label" | "state" | "address" | "lastSeenUs" | "heldBy" | "endingCommands" | "outOfService" | "outOfServiceReason" | "hasPose">;

// It has an adapter, or had one. Only the adapter knows how such a robot is. A robot that people play has no adapter and is never offline.
export function tellsItself(robot: Known | undefined): boolean {
  return robot !== undefined && (robot.address !== "" || robot.state === "offline");
}
export function isOwnFact(subject: string, property: string, robots: readonly Known[]): boolean {
  return own.has(property) && tellsItself(robots.find((r) => r.robot === subject));
}
export function isReadiness(property: string): boolean {
  return readiness.has(property);
}

// Why the robot can't begin; empty: nothing is known against it.
export function whyNotReady(r: Known, run = ""): string {
  const name = r.label || r.robot.replace(/^.*[#/]/, "");
  if (r.outOfService) return `${name} is out of service${r.outOfServiceReason ? `: ${r.outOfServiceReason}` : ""}`;
  if (r.state === "offline") return r.lastSeenUs > 0n ? `${name} is offline since ${clock(r.lastSeenUs)}` : `${name} is offline: its adapter has not joined`;
  if (r.state === "charging") return `${name} is charging`;
  if (r.state === "maintenance") return `${name} is in maintenance`;
  if (r.endingCommands.length > 0) return `${name} still ends a command`;
  if (r.heldBy !== "" && r.heldBy !== run) return `${name} works for ${runWords(r.heldBy)}`;
  if (r.state === "busy") return `${name} is busy`;
  return r.hasPose ? "" : `${name} does not know where it is`;
}

const shown = 4;
// Of the robots that would do, those that are nearest to being free first.
export function noRobotWords(robots: readonly Known[], run = ""): string {
  const order = (r: Known) => (r.outOfService ? 4 : ["busy", "standby"].includes(r.state) ? 0 : r.state === "charging" ? 1 : r.state === "maintenance" ? 2 : 3);
  const why = [...robots].sort((a, b) => order(a) - order(b)).map((r) => whyNotReady(r, run)).filter(Boolean);
  return why.length === 0 ? "" : `No robot can come: ${why.slice(0, shown).join("; ")}${why.length > shown ? `; and ${why.length - shown} more` : ""}`;
}
