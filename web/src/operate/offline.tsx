// Robots that are offline in the middle of a run: said where the run is, since nothing moves until they are back.
import { Unplug } from "lucide-react";
import { nameOf } from "../api/labels";
import { type Lost, sinceWords } from "./runs_within";

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
