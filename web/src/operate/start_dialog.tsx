// Starts a run by hand, with the values that the flow begins with; and the fields of these values.
import { CircleAlert, Play, X } from "lucide-react";
import { useState } from "react";
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { randomUuid } from "../api/ids";
import { navigate, paths } from "../app/router";
import { words } from "../cawl/names";
import { ofClass, type Vocabulary } from "../compose/vocabulary";
import { termOf } from "../api/terms";
import { writtenValue } from "../cawl/values";
import { Combo } from "../ui/combo";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { runWords } from "./states";

export interface StartVariable {
  name: string;
  type: string;
  initial: string;
}
// Of the variables of a document and its flow: each name once.
export function startVariables(variables: readonly StartVariable[]): StartVariable[] {
  return variables.filter((v, i, all) => v.name && all.findIndex((w) => w.name === v.name) === i).map(({ name, type, initial }) => ({ name, type, initial }));
}
// Throws RangeError with what is wrong.
export function startArguments(values: Readonly<Record<string, string>>, prefixes: ReadonlyMap<string, string>, variables: readonly StartVariable[] = []) {
  const typeOf = (name: string) => {
    const [prefix = "", local = ""] = (variables.find((v) => v.name === name)?.type ?? "").split(":");
    return local ? (prefixes.get(prefix) ?? "") + local : "";
  };
  return Object.entries(values).filter(([, text]) => text.trim() !== "").map(([name, text]) => ({ name, value: termOf(writtenValue(text, typeOf(name)), prefixes) }));
}

// Of which class it is, where its name does not say so.
function kindWords(v: StartVariable): string {
  const kind = words(v.type.replace(/^[\w-]+:/, "")).toLowerCase();
  return kind === words(v.name).toLowerCase() ? "" : kind;
}

// One field a variable; things of its class are offered.
export function StartFields(props: { variables: readonly StartVariable[]; values: Readonly<Record<string, string>>; vocabulary: Vocabulary; onChange: (values: Record<string, string>) => void }) {
  return props.variables.map((v) => (
    <div key={v.name} className="property-pair" style={{ alignItems: "center" }}>
      <span>{words(v.name)} <span className="faint small">{kindWords(v)}</span></span>
      <Combo label={v.name} placeholder={v.initial || "not given"} value={props.values[v.name] ?? ""} onChange={(value) => props.onChange({ ...props.values, [v.name]: value })} choices={ofClass(props.vocabulary, v.type).map((t) => ({ value: t.term, label: t.label, use: t.use }))} />
    </div>
  ));
}

export function StartDialog(props: {
  workflow: string; flow: string; variables: readonly StartVariable[]; vocabulary: Vocabulary; prefixes: ReadonlyMap<string, string>; onClose: () => void;
}) {
  const [values, setValues] = useState<Record<string, string>>({});
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<PlainError | null>(null);
  const { variables } = props;
  const start = async () => {
    setBusy(true);
    try {
      const reply = await workflows.start({ workflow: props.workflow, flow: props.flow, variables: startArguments(values, props.prefixes, variables), requestId: randomUuid() });
      toast("good", "The run has begun", runWords(reply.run));
      props.onClose();
      navigate(paths.run(reply.run));
    } catch (failure) {
      setError(failure instanceof RangeError ? { kind: "refused", title: "A value can't be read", detail: failure.message } : plain(failure));
      setBusy(false);
    }
  };
  return (
    <Dialog label="Start a run" width={480} onClose={props.onClose}>
      <div className="sheet-head"><h2 className="grow">Start {props.workflow}</h2><button className="button plain icon small" aria-label="Close" onClick={props.onClose}><X size={15} /></button></div>
      <div className="sheet-body" style={{ display: "grid", gap: 10 }}>
        <p className="quiet">{variables.length > 0 ? "Give the values that it needs at its beginning; the rest it finds by its conditions." : "It needs no values."}</p>
        <StartFields variables={variables} values={values} vocabulary={props.vocabulary} onChange={setValues} />
        {error && <div className="notice bad" role="alert"><CircleAlert size={15} /><div><b>{error.title}.</b> {error.detail}</div></div>}
      </div>
      <div className="sheet-foot">
        <button className="button" onClick={props.onClose}>Cancel</button>
        <button className="button primary" disabled={busy} onClick={() => void start()}><Play size={13} />Start</button>
      </div>
    </Dialog>
  );
}
