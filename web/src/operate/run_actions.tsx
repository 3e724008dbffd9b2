// What an operator can do with a run. Only what its state allows is offered.
import { Ban, FastForward, OctagonX, Pause, Play, RotateCw, X } from "lucide-react";
import { useState } from "react";
import { workflows } from "../api/client";
import { sentence } from "../api/errors";
import { nameOf } from "../api/labels";
import { useCommands } from "../ui/commands";
import { words } from "../cawl/names";
import { usePast } from "../api/past";
import { SettleRequest_How, type Node, type Run } from "../gen/docent/v1/workflows_pb";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { type UnderWay, underWay } from "./runs_within";
import { isLive, runWords } from "../ui/states";

export function attempt(what: string, call: () => Promise<unknown>, then: () => void) {
  call().then(
    () => (toast("good", what), then()),
    (error: unknown) => toast("bad", `Not done: ${what.toLowerCase()}`, sentence(error)),
  );
}

// "R01 still does Move2User (move to user)."
export function busyWords(busy: readonly UnderWay[]): string {
  const what = (b: UnderWay) =>
    words(b.operation).toLowerCase() === b.node.toLowerCase() ? "" : ` (${words(b.operation).toLowerCase()})`;
  return `${busy.map((b) => `${nameOf(b.robot)} still does ${b.node}${what(b)}`).join("; ")}.`;
}
// Of a run that is paused: its robot is not.
export function StillBusy({ run, runs, again }: { run: Run; runs: readonly Run[]; again: () => void }) {
  const past = usePast() !== null;
  const busy = run.paused ? underWay(run, runs) : [];
  if (busy.length === 0) return null;
  return (
    <div className="stale" role="status">
      <Pause size={14} />
      <span className="grow">
        Paused: {busyWords(busy)} It does so to its end, unless it is asked to stop.
      </span>
      {!past && (
        <button
          className="button small danger"
          onClick={() =>
            attempt(
              "The robot is asked to stop",
              () => workflows.pause({ what: { case: "run", value: run.id }, cancelCommands: true }),
              again,
            )
          }
        >
          <OctagonX size={12} />
          Stop it now
        </button>
      )}
    </div>
  );
}

// `keys`: they are commands of the view, too.
export function RunActions({
  run,
  runs,
  again,
  keys,
}: {
  run: Run;
  runs: readonly Run[];
  again: () => void;
  keys?: boolean;
}) {
  const [asking, setAsking] = useState(false);
  const [pausing, setPausing] = useState(false);
  const [reason, setReason] = useState("");
  const [undo, setUndo] = useState(false);
  const past = usePast() !== null;
  const there = isLive(run.state) && !past;
  const busy = underWay(run, runs);
  const pauseNow = (cancelCommands: boolean) =>
    attempt(
      cancelCommands ? "The run is paused, and its robot is asked to stop" : "The run is paused",
      () => workflows.pause({ what: { case: "run", value: run.id }, cancelCommands }),
      again,
    );
  const pause = () => (busy.length > 0 ? setPausing(true) : pauseNow(false));
  const resume = () =>
    attempt("The run goes on", () => workflows.resume({ what: { case: "run", value: run.id } }), again);
  useCommands(
    there && keys
      ? [
          run.paused
            ? { title: "Let the run go on", group: "Run", icon: Play, keys: "Shift+P", run: resume }
            : { title: "Pause the run", group: "Run", icon: Pause, keys: "Shift+P", run: pause },
          { title: "Cancel the run", group: "Run", icon: Ban, keys: "Shift+X", run: () => setAsking(true) },
        ]
      : [],
  );
  if (!there) return null;
  return (
    <>
      {run.paused ? (
        <button className="button" onClick={resume}>
          <Play size={13} />
          Go on
        </button>
      ) : (
        <button
          className="button"
          onClick={pause}
          title="No node opens and no command goes out; what is under way ends"
        >
          <Pause size={13} />
          Pause
        </button>
      )}
      <button className="button danger" onClick={() => setAsking(true)}>
        <Ban size={13} />
        Cancel
      </button>
      {pausing && (
        <Dialog label="Pause the run" width={440} onClose={() => setPausing(false)}>
          <div className="sheet-head">
            <h2 className="grow">Pause {runWords(run.id)}?</h2>
            <button className="button plain icon small" aria-label="Close" onClick={() => setPausing(false)}>
              <X size={15} />
            </button>
          </div>
          <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
            <p>{busyWords(busy)}</p>
            <p className="quiet">
              A pause lets it do so, and nothing new begins. A step that is stopped begins again when the run
              goes on, or asks you where it must not be repeated.
            </p>
          </div>
          <div className="sheet-foot">
            <button className="button danger" onClick={() => (setPausing(false), pauseNow(true))}>
              <OctagonX size={13} />
              Stop it now
            </button>
            <button
              className="button primary"
              data-first
              onClick={() => (setPausing(false), pauseNow(false))}
            >
              <Pause size={13} />
              Let it finish
            </button>
          </div>
        </Dialog>
      )}
      {asking && (
        <Dialog label="Cancel the run" width={440} onClose={() => setAsking(false)}>
          <div className="sheet-head">
            <h2 className="grow">Cancel {runWords(run.id)}?</h2>
            <button className="button plain icon small" aria-label="Close" onClick={() => setAsking(false)}>
              <X size={15} />
            </button>
          </div>
          <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
            <p className="quiet">
              Its commands are cancelled; its robot is free when it has stopped. A cancelled run does not come
              back.
            </p>
            <input
              className="field"
              placeholder="Why, for the record"
              aria-label="Reason"
              value={reason}
              onChange={(e) => setReason(e.target.value)}
            />
            <label className="row">
              <input type="checkbox" checked={undo} onChange={(e) => setUndo(e.target.checked)} />
              Undo what it has done, where its steps say how
            </label>
          </div>
          <div className="sheet-foot">
            <button className="button" onClick={() => setAsking(false)}>
              Let it run
            </button>
            <button
              className="button primary"
              style={{ background: "var(--bad)", color: "var(--surface)" }}
              onClick={() => (
                setAsking(false),
                attempt(
                  "The run is cancelled",
                  () => workflows.cancel({ run: run.id, reason, compensate: undo }),
                  again,
                )
              )}
            >
              Cancel the run
            </button>
          </div>
        </Dialog>
      )}
    </>
  );
}

// A node that failed and waits for somebody.
export function SettleButtons({ run, node, again }: { run: string; node: Node; again: () => void }) {
  const past = usePast() !== null;
  if (past || node.state !== "incident") return null;
  const settle = (how: SettleRequest_How, words: string) => () =>
    attempt(words, () => workflows.settle({ run, node: node.name, how }), again);
  return (
    <div className="row" style={{ flexWrap: "wrap" }}>
      <button className="button small" onClick={settle(SettleRequest_How.RETRY, "The step begins again")}>
        <RotateCw size={12} />
        Try again
      </button>
      <button className="button small" onClick={settle(SettleRequest_How.SKIP, "The step counts as done")}>
        <FastForward size={12} />
        Count as done
      </button>
      <button className="button small danger" onClick={settle(SettleRequest_How.FAIL, "The step has failed")}>
        <Ban size={12} />
        Let it fail
      </button>
    </div>
  );
}
