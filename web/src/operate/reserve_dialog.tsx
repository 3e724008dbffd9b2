// Keeps a robot for a run, for the runs of a workflow, or for none, for a while.
import { CalendarClock, CircleAlert, X } from "lucide-react";
import { useState } from "react";
import { fleet, workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { usePoll } from "../api/poll";
import type { Names } from "../api/prefixes";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { Combo, type Choice } from "../ui/combo";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";

const durations = [
  ["15", "15 minutes"],
  ["30", "half an hour"],
  ["60", "an hour"],
  ["240", "4 hours"],
  ["0", "until it is released"],
] as const;

export function ReserveDialog({
  robot,
  names,
  again,
  onClose,
}: {
  robot: RobotStatus;
  names: Names;
  again: () => void;
  onClose: () => void;
}) {
  const [keptFor, setKeptFor] = useState("");
  const [minutes, setMinutes] = useState("30");
  const [priority, setPriority] = useState("0");
  const [reason, setReason] = useState("");
  const [error, setError] = useState<PlainError | null>(null);
  const choices = usePoll(
    "kept for",
    async (signal): Promise<Choice[]> => {
      const [deployed, live] = await Promise.all([
        workflows.list({}, { signal }),
        workflows.listRuns({ liveOnly: true, pageSize: 100 }, { signal }),
      ]);
      return [
        ...deployed.workflows.map((w) => ({ value: w.name, label: "all of its runs", group: "Workflows" })),
        ...live.runs.filter((r) => !r.parent).map((r) => ({ value: r.id, group: "Live runs" })),
      ];
    },
    10_000,
  );
  const name = robot.label || names.name(robot.robot);
  const reserve = async () => {
    try {
      await fleet.reserve({
        robots: [robot.robot],
        keptFor: keptFor.trim(),
        priority: Number(priority) || 0,
        lastingMs: BigInt(minutes) * 60_000n,
        reason: reason.trim(),
      });
      toast(
        "good",
        `${name} is reserved`,
        keptFor ? `for ${keptFor}` : "No run takes it meanwhile, unless it is of a higher priority.",
      );
      again();
      onClose();
    } catch (failure) {
      setError(plain(failure));
    }
  };
  return (
    <Dialog label={`Reserve ${name}`} width={460} onClose={onClose}>
      <form onSubmit={(e) => (e.preventDefault(), void reserve())}>
        <div className="sheet-head">
          <h2 className="grow">Reserve {name}</h2>
          <button type="button" className="button plain icon small" aria-label="Close" onClick={onClose}>
            <X size={15} />
          </button>
        </div>
        <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
          <p className="quiet">
            Other runs take it only if they are of a higher priority. What a run holds already it keeps.
          </p>
          <div className="property">
            <span>For</span>
            <Combo
              label="For which workflow or run"
              placeholder="none: nobody gets it"
              value={keptFor}
              choices={choices.data ?? []}
              onChange={setKeptFor}
            />
          </div>
          <div className="property-pair">
            <label className="property">
              <span>How long</span>
              <select className="field" value={minutes} onChange={(e) => setMinutes(e.target.value)}>
                {durations
                  .filter(([m]) => m !== "0" || keptFor.trim())
                  .map(([m, words]) => (
                    <option key={m} value={m}>
                      {words}
                    </option>
                  ))}
              </select>
            </label>
            <label className="property">
              <span>Priority</span>
              <input
                className="field number"
                type="number"
                min={-1000}
                max={1000}
                value={priority}
                onChange={(e) => setPriority(e.target.value)}
              />
            </label>
          </div>
          <label className="property">
            <span>Why</span>
            <input
              className="field"
              value={reason}
              placeholder="for people"
              onChange={(e) => setReason(e.target.value)}
            />
          </label>
          {error && (
            <div className="notice bad" role="alert">
              <CircleAlert size={15} />
              <div>
                <b>{error.title}.</b> {error.detail}
              </div>
            </div>
          )}
        </div>
        <div className="sheet-foot">
          <button type="button" className="button" onClick={onClose}>
            Cancel
          </button>
          <button className="button primary">
            <CalendarClock size={14} />
            Reserve
          </button>
        </div>
      </form>
    </Dialog>
  );
}
