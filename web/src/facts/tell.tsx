// Facts that are missing: tried on a copy of the graph ("simulate"), or told for real; and the fields of a fact.
import { CircleAlert, FlaskConical, Megaphone, X } from "lucide-react";
import { useMemo, useState } from "react";
import { context } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { randomUuid } from "../api/ids";
import { replaceIris } from "../api/iris";
import type { Names } from "../api/prefixes";
import { termOf, termText } from "../api/terms";
import { create } from "@bufbuild/protobuf";
import { type Quad, QuadSchema } from "../gen/docent/v1/term_pb";
import type { WhatIfReply } from "../gen/docent/v1/context_pb";
import { useVocabulary } from "./vocabulary";
import { Combo } from "../ui/combo";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { factWords } from "./fact_words";
import { isOwnFact } from "./no_robot";
import { useFleet } from "./fleet";
import { look, runWords } from "../ui/states";

// What somebody wrote as subject, verb and object. Throws RangeError with what is wrong.
export function quadOfRow(
  [s = "", p = "", o = ""]: readonly string[],
  prefixes: ReadonlyMap<string, string>,
): Quad {
  if (!s.trim() || !p.trim() || !o.trim())
    throw new RangeError("The subject, the verb and the object are all needed.");
  return create(QuadSchema, {
    subject: termOf(s, prefixes),
    predicate: termOf(p === "a" ? "rdf:type" : p, prefixes),
    object: termOf(o, prefixes),
  });
}

// Subject, verb and object, with offers. `classes`: of the things that are meant, by place; these are offered first.
export function FactFields({
  row,
  names,
  classes = [],
  focused,
  onChange,
}: {
  row: readonly string[];
  names: Names;
  classes?: readonly (string | undefined)[];
  focused?: number; // the field that has the keys at first
  onChange: (row: string[]) => void;
}) {
  const vocabulary = useVocabulary(names.prefixes);
  const verbs = useMemo(
    () => vocabulary.verbs.map((t) => ({ value: t.term, label: t.label, use: t.use })),
    [vocabulary],
  );
  const things = (wanted: string | undefined) =>
    [
      ...vocabulary.things.filter((t) => wanted && t.classes?.includes(wanted)),
      ...vocabulary.things.filter((t) => !wanted || !t.classes?.includes(wanted)),
    ].map((t) => ({ value: t.term, label: t.label || t.use, use: t.use }));
  return (
    <div className="constraint-words" style={{ gridTemplateColumns: "1fr 1fr 1fr" }}>
      {["Subject", "Verb", "Object"].map((label, k) => (
        <Combo
          key={label}
          label={label}
          placeholder={label.toLowerCase()}
          value={row[k] ?? ""}
          choices={k === 1 ? verbs : things(classes[k])}
          autoFocus={k === focused}
          onChange={(value) => onChange(["", "", ""].map((_, l) => (l === k ? value : (row[l] ?? ""))))}
        />
      ))}
    </div>
  );
}

export function TellDialog(props: {
  title: string;
  quads: readonly Quad[];
  patterns: readonly string[];
  names: Names;
  onTold?: () => void;
  onClose: () => void;
}) {
  const { names } = props;
  const [rows, setRows] = useState(() =>
    props.quads.map((q) => [q.subject, q.predicate, q.object].map((term) => termText(term, names.short))),
  );
  const [effect, setEffect] = useState<WhatIfReply | null>(null);
  const [error, setError] = useState<PlainError | null>(null);
  const [busy, setBusy] = useState(false);
  const robots = useFleet();
  // That a robot tells of itself is tried here, and not told in its name: a robot that is off would count as ready.
  const ofRobot = robots.find((r) =>
    rows.some(([s = "", p = ""]) => isOwnFact(iriOf(s, names), iriOf(p, names), [r])),
  );
  const run = async (what: "simulate" | "tell") => {
    setBusy(true);
    setError(null);
    try {
      const add = rows.map((row) => quadOfRow(row, names.prefixes));
      if (what === "simulate")
        setEffect(await context.whatIf({ add, prefixes: Object.fromEntries(names.prefixes) }));
      else {
        const reply = await context.assert({ add, requestId: randomUuid() });
        toast(
          "good",
          reply.added > 0n ? "It is told" : "It was known already",
          rows.map((r) => r.join(" ")).join("\n"),
        );
        props.onTold?.();
        props.onClose();
      }
    } catch (failure) {
      setError(
        failure instanceof RangeError
          ? { kind: "refused", title: "That is no whole fact yet", detail: failure.message }
          : plain(failure),
      );
    }
    setBusy(false);
  };
  return (
    <Dialog label={props.title} width={600} onClose={props.onClose}>
      <div className="sheet-head">
        <h2 className="grow">{props.title}</h2>
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </div>
      <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
        <p className="quiet">
          {props.patterns.length > 0 ? (
            <>
              What is missing:{" "}
              {props.patterns.map((p, i) => (
                <span key={i} title={p}>
                  {i > 0 ? " and " : ""}
                  <b>{factWords(p, names.prefixes)}</b>
                </span>
              ))}
              . The values below are examples; choose the ones that are meant.
            </>
          ) : (
            "Who or what, which property of it, and the value. Put a text in quotes."
          )}
        </p>
        {rows.map((row, i) => (
          <FactFields
            key={i}
            row={row}
            names={names}
            onChange={(changed) => (setEffect(null), setRows(rows.map((r, j) => (j === i ? changed : r))))}
          />
        ))}
        {error && (
          <div className="notice bad" role="alert">
            <CircleAlert size={15} />
            <div>
              <b>{error.title}.</b> {error.detail}
            </div>
          </div>
        )}
        {ofRobot && (
          <div className="notice wait">
            <CircleAlert size={15} />
            <div>
              {ofRobot.label || names.name(ofRobot.robot)} tells this itself
              {ofRobot.state === "offline" ? ", and is offline" : ""}. You can simulate it; only the robot can
              tell it.
            </div>
          </div>
        )}
        {effect && (
          <div className="notice" role="status">
            <FlaskConical size={15} />
            <div>
              <b>If it were told:</b>
              {effect.transitions.length + effect.commands.length === 0 && <div>No run would move on.</div>}
              {effect.transitions.map((t, i) => (
                <div key={i}>
                  {runWords(t.subject)}: {look(t.from).words} → <b>{look(t.to).words}</b>
                </div>
              ))}
              {effect.commands.map((c, i) => (
                <div key={`c${i}`}>{commandWords(c, names)}</div>
              ))}
              {effect.added.length > rows.length && (
                <div className="faint">
                  {effect.added.length - rows.length === 1
                    ? "One more fact"
                    : `${effect.added.length - rows.length} more facts`}{" "}
                  would be inferred.
                </div>
              )}
            </div>
          </div>
        )}
      </div>
      <div className="sheet-foot">
        <button className="button" disabled={busy} onClick={() => void run("simulate")}>
          <FlaskConical size={14} />
          Simulate
        </button>
        {!ofRobot && (
          <button className="button primary" disabled={busy} onClick={() => void run("tell")}>
            <Megaphone size={14} />
            Tell it
          </button>
        )}
      </div>
    </Dialog>
  );
}

function iriOf(term: string, names: Names): string {
  return /^<([^>]*)>$/.exec(term.trim())?.[1] ?? names.long(term.trim());
}

// "ID to <robot>: operation(arguments), …" for people.
function commandWords(command: string, names: Names): string {
  const parts = / to <([^>]+)>: ([^\s(]+\((?:"(?:[^"\\]|\\.)*"|[^")])*\))/.exec(command);
  return parts
    ? `${names.name(parts[1] ?? "")} would get ${replaceIris(parts[2] ?? "", names.name)}`
    : command;
}
