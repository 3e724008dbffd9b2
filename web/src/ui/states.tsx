// States of runs and nodes as icon and words, never by colour alone; times for people.
import {
  Ban,
  CircleAlert,
  CircleCheck,
  CircleDashed,
  CirclePause,
  Hourglass,
  LoaderCircle,
  Send,
  SkipForward,
  Undo2,
  type LucideIcon,
} from "lucide-react";
import { shownNow } from "../api/past";

interface Look {
  words: string;
  tone: string;
  icon: LucideIcon;
}
const looks: Record<string, Look> = {
  running: { words: "running", tone: "busy", icon: LoaderCircle },
  waiting: { words: "waiting", tone: "wait", icon: Hourglass },
  pending: { words: "needs a robot", tone: "wait", icon: Hourglass },
  paused: { words: "paused", tone: "", icon: CirclePause },
  incident: { words: "needs you", tone: "bad", icon: CircleAlert },
  done: { words: "done", tone: "good", icon: CircleCheck },
  failed: { words: "failed", tone: "bad", icon: CircleAlert },
  cancelled: { words: "cancelled", tone: "", icon: Ban },
  compensating: { words: "undoing", tone: "wait", icon: Undo2 },
  skipped: { words: "skipped", tone: "", icon: SkipForward },
  sent: { words: "sent", tone: "busy", icon: Send },
  accepted: { words: "accepted", tone: "busy", icon: CircleCheck },
  succeeded: { words: "succeeded", tone: "good", icon: CircleCheck },
  inactive: { words: "not yet", tone: "", icon: CircleDashed },
};
export function look(state: string): Look {
  return looks[state] ?? { words: state, tone: "", icon: CircleDashed };
}

export function StateTag({ state }: { state: string }) {
  const { words, tone, icon: Icon } = look(state);
  return (
    <span className={`tag ${tone}`}>
      <Icon size={12} className={state === "running" ? "turn" : ""} />
      {words}
    </span>
  );
}

export const isLive = (state: string) => !["done", "failed", "cancelled"].includes(state);

// The id of a run, as people read it: "John's Service-2".
export function runWords(id: string): string {
  try {
    return decodeURIComponent(id);
  } catch {
    return id;
  }
}

export function seconds(us: bigint | number): number {
  return Number(us) / 1e6;
}
export function duration(fromUs: bigint, toUs: bigint): string {
  const s = Math.max(0, (Number(toUs) - Number(fromUs)) / 1e6);
  if (s < 60) return `${s < 10 ? s.toFixed(1) : Math.round(s)} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${Math.round(s % 60)} s`;
  return `${Math.floor(s / 3600)} h ${Math.round((s % 3600) / 60)} min`;
}
export { clock, Time, timeTitle } from "../api/times";
// The time that is shown: of the past where that is shown.
export const nowUs = () => BigInt(shownNow()) * 1000n;
