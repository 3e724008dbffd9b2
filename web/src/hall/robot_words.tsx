// What a robot does, in words.
import { words } from "../cawl/names";
import { clock } from "../ui/states";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";

export function taskWords(robot: RobotStatus): string {
  if (robot.outOfService)
    return `out of service${robot.outOfServiceReason ? `: ${robot.outOfServiceReason}` : ""}`;
  const task = robot.heldFor[0];
  // It may be no longer so, and its run may have failed meanwhile.
  if (robot.state === "offline")
    return [
      robot.lastSeenUs > 0n ? `not seen since ${clock(robot.lastSeenUs)}` : "not seen",
      task && `it had begun: ${words(task.operation).toLowerCase()}`,
    ]
      .filter(Boolean)
      .join("; ");
  if (robot.endingCommands.length > 0 && robot.heldFor.length <= robot.endingCommands.length)
    return task ? `ends ${words(task.operation).toLowerCase()}` : "ends a command";
  if (task) return words(task.operation);
  return robot.heldBy ? "waits for its run" : robot.state === "standby" ? "free" : "";
}

export function RobotTag({ state }: { state: string }) {
  const tone = { standby: "good", busy: "busy", charging: "wait", offline: "bad" }[state] ?? "";
  return <span className={`tag ${tone}`}>{state}</span>;
}
