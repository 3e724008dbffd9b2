// Robots that are offline in the middle of a run: said where the run is, since nothing moves until they are back.
import { Unplug } from "lucide-react";
import { useMemo } from "react";
import { useAsOf } from "../api/as_of";
import { fleet } from "../api/client";
import { nameOf } from "../api/labels";
import { usePast } from "../api/past";
import { usePoll } from "../api/poll";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { askRobots } from "./past_hall";
import { type Lost, sinceWords } from "./runs_within";

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

export function LostTag({ lost }: { lost: readonly Lost[] }) {
  return lost.map((r) => (
    <span key={r.robot} className="tag wait" title="Nothing more is heard of its step until it is back">
      <Unplug size={12} />
      {r.label || nameOf(r.robot)} offline{sinceWords(r)}
    </span>
  ));
}
export function LostBar({ lost }: { lost: readonly Lost[] }) {
  if (lost.length === 0) return null;
  return (
    <div className="stale" role="status">
      <Unplug size={14} />
      <span>
        {lost
          .map(
            (r) =>
              `${r.label || nameOf(r.robot)} ${r.lastSeenUs > 0n ? "has been" : "is"} offline${sinceWords(r)}`,
          )
          .join("; ")}
        . Nothing more is heard of its step until it is back.
      </span>
    </div>
  );
}
