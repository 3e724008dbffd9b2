// What a robot does, in words.
import { words } from "../cawl/names";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";

export function taskWords(robot: RobotStatus): string {
  if (robot.outOfService) return `out of service${robot.outOfServiceReason ? `: ${robot.outOfServiceReason}` : ""}`;
  const task = robot.heldFor[0];
  if (task) return words(task.operation);
  if (robot.endingCommands.length > 0) return "ends a command";
  return robot.heldBy ? "waits for its run" : robot.state === "standby" ? "free" : "";
}

export function RobotTag({ state }: { state: string }) {
  const tone = { standby: "good", busy: "busy", charging: "wait", offline: "bad" }[state] ?? "";
  return <span className={`tag ${tone}`}>{state}</span>;
}
