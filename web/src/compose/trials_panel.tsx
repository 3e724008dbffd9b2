// Past runs below the canvas: tried with the document as it is now, kept as tests, saved as files.
import {
  ChevronDown,
  ChevronUp,
  CircleAlert,
  CircleCheck,
  Download,
  GitCompareArrows,
  History,
  LoaderCircle,
  Star,
} from "lucide-react";
import { replays } from "../api/client";
import { sentence } from "../api/errors";
import { replaceIris } from "../api/iris";
import type { Names } from "../api/prefixes";
import { nameOf } from "../api/labels";
import { Link } from "../ui/link";
import { paths } from "../ui/router";
import type { ReplayDifference, ReplayReply } from "../gen/docent/v1/replays_pb";
import { clock, runWords } from "../ui/states";
import { factsOf } from "../facts/fact_words";
import { toast } from "../ui/toasts";
import { saveFile } from "./files";
import { firstDifference, type Trial, type Trials } from "./trials";
import "./trials.css";

export function TrialsPanel(props: {
  trials: Trials;
  text: string;
  names: Names;
  open: boolean;
  chosen: string;
  onToggle: () => void;
  onChoose: (run: string) => void;
  onStep: (name: string) => void;
}) {
  const { trials, text } = props;
  const kept = trials.list.filter((t) => t.kept).length;
  return (
    <section className="findings" aria-label="Past runs">
      <button className="findings-bar" aria-expanded={props.open} onClick={props.onToggle}>
        <History size={14} />
        <span>Try on past runs</span>
        {kept > 0 && trials.differing === 0 && (
          <span className="faint">
            {kept === 1 ? "1 test" : `${kept} tests`}
            {trials.list.some((t) => t.kept && t.busy) ? ", trying" : ""}
          </span>
        )}
        {trials.differing > 0 && (
          <span className="row" style={{ gap: "var(--space-2)" }}>
            <GitCompareArrows size={14} className="warn" />
            {trials.differing} of {kept} {kept === 1 ? "test" : "tests"} would go differently
          </span>
        )}
        <span className="grow" />
        {props.open ? <ChevronDown size={14} /> : <ChevronUp size={14} />}
      </button>
      {props.open && (
        <div className="trials" tabIndex={0} aria-label="Runs">
          <p className="trials-hint faint small">
            <span className="grow">
              {trials.list.length === 0
                ? trials.error
                  ? `${trials.error.title}.`
                  : "This workflow has not run yet. Its past runs can be replayed here after each edit, without robots."
                : "A past run is replayed with this document, on the facts of then and with the answers that robots gave. Nothing is sent, nothing changes."}
            </span>
            {trials.list.length > 0 && (
              <label className="row">
                <input
                  type="checkbox"
                  checked={trials.assume}
                  onChange={(e) => trials.setAssume(e.target.checked)}
                />
                Simulate: commands that were not sent then count as done
              </label>
            )}
          </p>
          <ul>
            {trials.list.map((t) => (
              <TrialRow
                key={t.run}
                {...props}
                trial={t}
                old={t.text !== "" && t.text !== text}
                open={props.chosen === t.run}
              />
            ))}
          </ul>
        </div>
      )}
    </section>
  );
}

function TrialRow(props: {
  trials: Trials;
  trial: Trial;
  old: boolean;
  open: boolean;
  names: Names;
  onChoose: (run: string) => void;
  onStep: (name: string) => void;
}) {
  const { trial, trials } = props;
  const user = trial.of?.variables.find((v) => v.name === "user" || v.name === "visitor")?.value?.kind;
  const attempt = () => (props.onChoose(trial.run), void trials.attempt(trial.run));
  const save = () =>
    replays.save({ run: trial.run }).then(
      (reply) => (
        saveFile(`${trial.run}.run.json`, reply.saved),
        reply.warnings.length > 0 &&
          toast("bad", "The file does not tell all that this run went by", reply.warnings.join("\n"))
      ),
      (error: unknown) => toast("bad", "The run can’t be saved", sentence(error)),
    );
  return (
    <li className={props.open ? "open" : ""}>
      <div className="trial">
        <button
          className="button plain icon small"
          aria-pressed={trial.kept}
          aria-label={trial.kept ? `Drop the test ${trial.run}` : `Keep ${trial.run} as a test`}
          title={
            trial.kept
              ? "A test: it is tried after each edit"
              : "Keep it as a test, which is tried after each edit"
          }
          onClick={() => void trials.keep(trial.run, !trial.kept)}
        >
          <Star size={14} fill={trial.kept ? "currentColor" : "none"} />
        </button>
        <Link href={paths.run(trial.run)} className="run-id cut">
          {runWords(trial.run)}
        </Link>
        <span className="faint small cut grow">
          {trial.of
            ? [clock(trial.of.startedUs), user?.case === "iri" && `for ${nameOf(user.value)}`, trial.of.state]
                .filter(Boolean)
                .join(" · ")
            : "no longer in the list of runs"}
        </span>
        <Verdict trial={trial} old={props.old} />
        <button className="button small" disabled={trial.busy} onClick={attempt}>
          {trial.busy ? <LoaderCircle size={12} className="turn" /> : <History size={12} />}Try
        </button>
        <button
          className="button plain icon small"
          aria-label={`Save ${trial.run} as a file`}
          title="Save it as a file for docent test"
          onClick={() => void save()}
        >
          <Download size={13} />
        </button>
        <button
          className="button plain icon small"
          aria-expanded={props.open}
          aria-label={`Details of ${trial.run}`}
          disabled={!trial.reply && !trial.error}
          onClick={() => props.onChoose(props.open ? "" : trial.run)}
        >
          {props.open ? <ChevronDown size={13} /> : <ChevronUp size={13} />}
        </button>
      </div>
      {props.open && trial.error && (
        <p className="notice bad">
          <CircleAlert size={14} />
          {trial.error}
        </p>
      )}
      {props.open && trial.reply && (
        <Differences reply={trial.reply} names={props.names} onStep={props.onStep} />
      )}
    </li>
  );
}

function Verdict({ trial, old }: { trial: Trial; old: boolean }) {
  if (trial.error)
    return (
      <span className="tag bad">
        <CircleAlert size={12} />
        can’t be tried
      </span>
    );
  if (!trial.reply) return null;
  const aged = old ? " before the edit" : "";
  if (trial.reply.same)
    return (
      <span className={`tag ${old ? "" : "good"}`}>
        <CircleCheck size={12} />
        goes the same{aged}
      </span>
    );
  return (
    <span className={`tag ${old ? "" : "wait"}`}>
      <GitCompareArrows size={12} />
      differs at {firstDifference(trial.reply) || "its end"}
      {aged}
    </span>
  );
}

// What a difference is about, for people.
const kinds: Record<string, string> = {
  activator: "starts",
  turn: "does it at another time",
  state: "comes into another state",
  "not reached": "is not reached",
  "no such node": "is not in this document",
  further: "does more",
  command: "sends another command",
  robot: "takes another robot",
  value: "gives another value",
  variable: "has another value",
  result: "gives another result",
};

function Differences({
  reply,
  names,
  onStep,
}: {
  reply: ReplayReply;
  names: Names;
  onStep: (name: string) => void;
}) {
  const short = (text: string) => replaceIris(text, names.short);
  const side = (title: string, text: string) =>
    text && (
      <p>
        <span className="faint">{title}</span> {short(text)}
      </p>
    );
  const row = (d: ReplayDifference, i: number) => (
    <div key={i} className="difference">
      <b>{kinds[d.kind] ?? d.kind}</b>
      {side("then", d.recorded)}
      {side("now", d.replayed)}
    </div>
  );
  return (
    <div className="differences small">
      {reply.same && (
        <p className="row quiet">
          <CircleCheck size={13} />
          Each step does what it did then{reply.state ? `; the run is ${reply.state}` : ""}.
        </p>
      )}
      {reply.nodes
        .filter((n) => !n.same)
        .map((n) => (
          <div key={n.node} className="difference-node">
            <button className="difference-step" onClick={() => onStep(n.node)}>
              {n.node || "The run"}
            </button>
            {n.differences.slice(0, 6).map(row)}
            {n.missing && (
              <p>
                <span className="faint">missing:</span> {factsOf(n.missing, names).join(", ")}
              </p>
            )}
          </div>
        ))}
      {reply.stopped && (
        <p className="notice wait">
          <CircleAlert size={14} />
          <span>
            It was tried up to {reply.stoppedNode || "there"}: {short(reply.stopped)}
          </span>
        </p>
      )}
      {reply.notes.map((note) => (
        <p key={note} className="faint">
          {note}
        </p>
      ))}
    </div>
  );
}
