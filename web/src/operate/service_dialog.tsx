// Takes a robot out of service, with a reason that everybody reads who waits for it.
import { PowerOff, X } from "lucide-react";
import { useState } from "react";
import { fleet } from "../api/client";
import type { RobotStatus } from "../gen/docent/v1/fleet_pb";
import { Dialog } from "../ui/dialog";
import { attempt } from "./run_actions";

export function ServiceDialog({
  robot,
  name,
  again,
  onClose,
}: {
  robot: RobotStatus;
  name: string;
  again: () => void;
  onClose: () => void;
}) {
  const [reason, setReason] = useState("");
  const [stops, setStops] = useState(false);
  const busy = robot.heldFor.length > 0;
  const take = (event: React.FormEvent) => {
    event.preventDefault();
    onClose();
    attempt(
      `${name} is out of service`,
      () => fleet.takeOutOfService({ robot: robot.robot, cancelCommands: stops, reason: reason.trim() }),
      again,
    );
  };
  return (
    <Dialog label={`Take ${name} out of service`} width={440} onClose={onClose}>
      <form onSubmit={take}>
        <div className="sheet-head">
          <h2 className="grow">Take {name} out of service?</h2>
          <button type="button" className="button plain icon small" aria-label="Close" onClick={onClose}>
            <X size={15} />
          </button>
        </div>
        <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
          <p className="quiet">It gets no further command until it is put in service.</p>
          <input
            className="field"
            data-first
            placeholder="Why, for everybody who waits for it"
            aria-label="Reason"
            value={reason}
            onChange={(e) => setReason(e.target.value)}
          />
          {busy && (
            <label className="row">
              <input type="checkbox" checked={stops} onChange={(e) => setStops(e.target.checked)} />
              Stop what it does now
            </label>
          )}
        </div>
        <div className="sheet-foot">
          <button type="button" className="button" onClick={onClose}>
            Leave it in service
          </button>
          <button className="button primary">
            <PowerOff size={13} />
            Take out of service
          </button>
        </div>
      </form>
    </Dialog>
  );
}
