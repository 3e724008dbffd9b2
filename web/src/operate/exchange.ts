// Whether a run can be given another robot, and which. Pure functions.
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import type { Node, Run } from "../gen/docent/v1/workflows_pb";
import { whyNotReady } from "../facts/no_robot";
import { underWay } from "./runs_within";
import { isLive } from "../ui/states";

export interface Exchange {
  how: "retry" | "set"; // settle the node with another robot, or set the variables that name the robot
  robot: string; // IRI of the one that is exchanged; empty: not known
  values: { run: string; name: string }[]; // set: variables of the run, and of those that it is a part of
  operations: string[]; // that the node's robots have to know, as far as it is known
}

// Null: it can't be done. A step that is open keeps the robot with which it opened; one that waits for its situation is asked with
// the new value.
export function exchangeOf(
  run: Run,
  node: Node,
  runs: readonly Run[],
  causes: readonly string[],
): Exchange | null {
  if (!isLive(run.state)) return null;
  const operations = [...new Set(node.invocations.map((i) => i.operation))];
  if (node.state === "incident")
    return {
      how: "retry",
      robot: node.invocations.find((i) => i.robot)?.robot ?? "",
      values: [],
      operations,
    };
  if (node.state !== "waiting") return null;
  const line = lineOf(run, runs);
  const robot = causes.find((cause) => run.variables.some((v) => iriOf(v) === cause));
  // What has begun with the robot ends with it.
  if (robot === undefined || underWay(line.at(-1) ?? run, runs).some((busy) => busy.robot === robot))
    return null;
  return {
    how: "set",
    robot,
    values: line.flatMap((one) =>
      one.variables.filter((v) => iriOf(v) === robot).map((v) => ({ run: one.id, name: v.name })),
    ),
    operations,
  };
}

// Those that are ready come first.
export function fitFor(exchange: Exchange, robots: readonly RobotStatus[]): RobotStatus[] {
  const order = (r: RobotStatus) =>
    whyNotReady(r) === "" ? 0 : r.state === "offline" || r.outOfService ? 2 : 1;
  const old = robots.find((r) => r.robot === exchange.robot);
  const wanted = exchange.operations.length > 0 ? exchange.operations : (old?.operations ?? []);
  const known = wanted.filter((operation) => robots.some((r) => r.operations.includes(operation))); // the others are services
  return robots
    .filter((r) => r.robot !== exchange.robot && known.every((operation) => r.operations.includes(operation)))
    .sort((a, b) => order(a) - order(b));
}

// The run, and those that it is a part of.
function lineOf(run: Run, runs: readonly Run[]): Run[] {
  const line = [run];
  for (
    let outer = runs.find((r) => r.id === run.parent);
    outer && !line.includes(outer);
    outer = runs.find((r) => r.id === outer?.parent)
  )
    line.push(outer);
  return line;
}
function iriOf(variable: Run["variables"][number]): string {
  return variable.value?.kind.case === "iri" ? variable.value.kind.value : "";
}
