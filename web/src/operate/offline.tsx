// Robots that are offline in the middle of a run: said where the run is, since nothing moves until they are back.
import { Unplug } from "lucide-react";
import { useAsOf } from "../api/as_of";
import { fleet } from "../api/client";
import { nameOf } from "../api/labels";
import { usePast } from "../api/past";
import { usePoll } from "../api/poll";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { askRobots } from "./past_hall";
import { type Lost, sinceWords } from "./runs_within";

const everyMs = 2000;

export function useOfflineRobots(): readonly RobotStatus[] {
  const at = usePast();
  const now = usePoll(at === null ? "robots that are offline" : "", async (signal) => (await fleet.list({}, { signal })).robots.filter((r) => r.state === "offline"), everyMs);
  const then = useAsOf("robots", at, askRobots);
  return (at === null ? now.data : then.data?.robots.filter((r) => r.state === "offline")) ?? [];
}

export function LostTag({ lost }: { lost: readonly Lost[] }) {
  return lost.map((r) => <span key={r.robot} className="tag wait" title="Nothing more is heard of its step until it is back"><Unplug size={12} />{r.label || nameOf(r.robot)} offline{sinceWords(r)}</span>);
}
export function LostBar({ lost }: { lost: readonly Lost[] }) {
  if (lost.length === 0) return null;
  return <div className="stale" role="status"><Unplug size={14} />{lost.map((r) => `${r.label || nameOf(r.robot)} ${r.lastSeenUs > 0n ? "has been" : "is"} offline${sinceWords(r)}`).join("; ")}. Nothing more is heard of its step until it is back.</div>;
}
