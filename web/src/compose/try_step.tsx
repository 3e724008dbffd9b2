// One step tried without a robot: on the facts of now, or of a past run. It says whether the step opens, with which values, and
// what it would send.
import { CircleAlert, CircleCheck, FlaskConical, Hourglass } from "lucide-react";
import { useState } from "react";
import { replays } from "../api/client";
import { sentence } from "../api/errors";
import { replaceIris } from "../api/iris";
import { useNames, type Names } from "../api/prefixes";
import { termText } from "../api/terms";
import type { CawlDocument, Invoke, Step } from "../cawl/document";
import { words } from "../cawl/names";
import type { TryNodeReply } from "../gen/docent/v1/replays_pb";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";
import { clock } from "../ui/states";
import { factsOf } from "../facts/fact_words";
import { rowsOf, situationAsks } from "./condition_editor";
import { ofKinds, useLive, type Live } from "./live";
import type { PaletteEntry } from "../flow/palette_data";
import type { Trial } from "./trials";
import "./trials.css";

interface TryStepProps {
  document: CawlDocument;
  flow: string;
  step: Step;
  place: string; // as of ConditionEditor
  variables: readonly { name: string; type: string }[];
  compiled: readonly CompiledCondition[];
  palette: readonly PaletteEntry[];
  runs: readonly Trial[];
  text: string;
}

export function TryStep(props: TryStepProps) {
  const [run, setRun] = useState("");
  const runs = props.runs.filter((t) => !t.of || t.of.flow === props.flow);
  return (
    <div className="try-step">
      <label className="property">
        <span>On the facts</span>
        <select
          className="field small"
          aria-label="On which facts the step is tried"
          value={run}
          onChange={(e) => setRun(e.target.value)}
        >
          <option value="">of now</option>
          {runs.map((t) => (
            <option key={t.run} value={t.run}>
              of {t.run}
              {t.of ? `, ${clock(t.of.startedUs)}` : ""}
            </option>
          ))}
        </select>
      </label>
      {run === "" ? <Now {...props} /> : <Then key={run} {...props} run={run} />}
    </div>
  );
}

function Now({ document, step, place, variables, compiled, palette }: TryStepProps) {
  const contexts = step.condition?.contexts ?? [];
  const kinds = new Map(
    variables.filter((v) => v.type && !v.type.startsWith("xsd:")).map((v) => [v.name, v.type]),
  );
  const rows = contexts.flatMap((context, c) =>
    context.rules.flatMap((rule) =>
      rule.constraints.map((constraint, k) => ({ id: `${c}.${k}`, constraint })),
    ),
  );
  const asks = step.condition ? situationAsks(compiled, place, step.condition) : [];
  const live = useLive(
    document,
    asks.map(({ id, ask }) => ({ id, ask: ofKinds(document, ask, rowsOf(id, rows), kinds) })),
  );
  const holds = [...live.values()].find((l) => l.matches > 0);
  if (contexts.length > 0 && live.size === 0)
    return <p className="faint small">Not asked yet: the text has to be without mistakes.</p>;
  if (contexts.length > 0 && !holds)
    return (
      <p className="row small">
        <Hourglass size={13} />
        It would wait: its situation is not true now. What is missing is listed above.
      </p>
    );
  return (
    <div role="status" className="small try-step">
      <p className="row">
        <CircleCheck size={13} />
        It would open{holds?.witness ? ` with ${holds.witness}` : " as soon as its turn comes"}.
      </p>
      {step.invokes.length > 0 && (
        <ul>
          {step.invokes.map((invoke, i) => (
            <li key={i}>
              would call{" "}
              <code>
                {words(invoke.target)}(
                {argumentsOf(
                  palette.find((p) => p.id === invoke.target),
                  invoke,
                  holds,
                )}
                )
              </code>
            </li>
          ))}
        </ul>
      )}
    </div>
  );
}

function argumentsOf(entry: PaletteEntry | undefined, invoke: Invoke, holds: Live | undefined): string {
  const own = (name: string) => invoke.inputs.find((i) => i.part === name)?.expression;
  return (entry?.inputs ?? [])
    .map((i) => `${i.name} = ${own(i.name) ?? holds?.found[i.name] ?? "as the run has it"}`)
    .join(", ");
}

function Then({ step, text, document, run }: TryStepProps & { run: string }) {
  const names = useNames();
  const [tried, setTried] = useState<{ text: string; reply?: TryNodeReply; error?: string } | null>(null);
  const [busy, setBusy] = useState(false);
  const attempt = async () => {
    setBusy(true);
    try {
      setTried({
        text,
        reply: await replays.tryNode({ run, node: step.name, name: `${document.name}.cawl.xml`, cawl: text }),
      });
    } catch (error) {
      setTried({ text, error: sentence(error) });
    }
    setBusy(false);
  };
  return (
    <>
      <button
        className="button small"
        style={{ justifySelf: "start" }}
        disabled={busy}
        onClick={() => void attempt()}
      >
        <FlaskConical size={13} />
        {busy ? "Trying" : "Try this step"}
      </button>
      {tried?.error && (
        <p className="notice bad" role="alert">
          <CircleAlert size={14} />
          {tried.error}
        </p>
      )}
      {tried?.reply && <Answer reply={tried.reply} names={names} />}
      {tried && tried.text !== text && <p className="faint small">The text has changed since.</p>}
    </>
  );
}

export function Answer({ reply, names }: { reply: TryNodeReply; names: Names }) {
  const values = (terms: readonly { name: string; value?: Parameters<typeof termText>[0] }[]) =>
    terms.map((t) => `${t.name} = ${termText(t.value, names.short)}`).join(", ");
  return (
    <div role="status" className="small try-step">
      <p className="row">
        {reply.opens ? <CircleCheck size={13} /> : <Hourglass size={13} />}
        {reply.opens ? "It opens" : "It does not open"} on the facts of turn {String(reply.turn)}.
      </p>
      {reply.bindings.length > 0 && (
        <p>
          The match gives <code>{values(reply.bindings)}</code>
        </p>
      )}
      {reply.variables.length > 0 && (
        <p className="faint">
          The run had <code>{values(reply.variables)}</code>
        </p>
      )}
      {reply.commands.length > 0 && (
        <ul>
          {reply.commands.map((c, i) => (
            <li key={i}>
              {names.name(c.robot) || "a robot"} would get{" "}
              <code>
                {c.operation}({values(c.arguments)})
              </code>
            </li>
          ))}
        </ul>
      )}
      {reply.pending && <p>It sends nothing yet: {replaceIris(reply.pending, names.name)}</p>}
      {reply.missing && (
        <p>
          Missing:{" "}
          {factsOf(reply.missing, names).map((fact) => (
            <code key={fact}>{fact} </code>
          ))}
        </p>
      )}
      {reply.state === "failed" && <p>{reply.reason}</p>}
    </div>
  );
}
