// The robots as the server knows them, now or at the time that is shown.
import { useMemo } from "react";
import { useAsOf } from "../api/as_of";
import { fleet } from "../api/client";
import { usePast } from "../api/past";
import { usePoll } from "../api/poll";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { askRobots } from "./past_robots";

const everyMs = 2000;

// All robots, of now or of the time that is shown.
export function useFleet(): readonly RobotStatus[] {
  const at = usePast();
  const now = usePoll(
    at === null ? "fleet" : "",
    async (signal) => (await fleet.list({}, { signal })).robots,
    everyMs,
  );
  const then = useAsOf("robots", at, askRobots);
  return (at === null ? now.data : then.data?.robots) ?? none;
}
const none: readonly RobotStatus[] = [];
export function useOfflineRobots(): readonly RobotStatus[] {
  const robots = useFleet();
  return useMemo(() => robots.filter((r) => r.state === "offline"), [robots]);
}
