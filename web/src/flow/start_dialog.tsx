// Starts a run by hand, with the values that the flow begins with; and the fields of these values.
import { CircleAlert, Play, X } from "lucide-react";
import { useState } from "react";
import { workflows } from "../api/client";
import { plain, type PlainError } from "../api/errors";
import { randomUuid } from "../api/ids";
import { navigate, paths } from "../ui/router";
import { words } from "../cawl/names";
import type { StartVariable } from "../cawl/start_values";
import { ofClass, type Vocabulary } from "../facts/vocabulary";
import { termOf } from "../api/terms";
import { shownValue, writtenValue } from "../cawl/values";
import { Combo } from "../ui/combo";
import { Dialog } from "../ui/dialog";
import { toast } from "../ui/toasts";
import { runWords } from "../ui/states";

// Throws RangeError with what is wrong.
export function startArguments(
  values: Readonly<Record<string, string>>,
  prefixes: ReadonlyMap<string, string>,
  variables: readonly Pick<StartVariable, "name" | "type">[] = [],
) {
  const typeOf = (name: string) => {
    const [prefix = "", local = ""] = (variables.find((v) => v.name === name)?.type ?? "").split(":");
    return local ? (prefixes.get(prefix) ?? "") + local : "";
  };
  return Object.entries(values)
    .filter(([, text]) => text.trim() !== "")
    .map(([name, text]) => ({ name, value: termOf(writtenValue(text, typeOf(name)), prefixes) }));
}

// Of which class it is, where its name does not say so.
function kindWords(v: StartVariable): string {
  const kind = words(v.type.replace(/^[\w-]+:/, "")).toLowerCase();
  return kind === words(v.name).toLowerCase() ? "" : kind;
}

// What stands in its field as long as nothing is given.
function needWords(v: StartVariable): string {
  return v.need === "set"
    ? shownValue(v.initial)
    : { needed: "needed", found: "found by a condition", made: "made by its steps", any: "one that is free" }[
        v.need
      ];
}
function isText(v: StartVariable): boolean {
  return v.type === "xsd:string" || (v.type === "" && v.name === "text");
}
// "user and booth"
function listed(variables: readonly StartVariable[]): string {
  const all = variables.map((v) => words(v.name).toLowerCase());
  return all.length < 2 ? all.join("") : `${all.slice(0, -1).join(", ")} and ${all.at(-1)}`;
}

// One field a variable; things of its class are offered. `live`: each key counts, so that what is missing is known while somebody types.
export function StartFields(props: {
  variables: readonly StartVariable[];
  values: Readonly<Record<string, string>>;
  vocabulary: Vocabulary;
  live?: boolean;
  onChange: (values: Record<string, string>) => void;
}) {
  return props.variables.map((v) => (
    <div key={v.name} className="property-pair" style={{ alignItems: "center" }}>
      <span>
        {words(v.name)} <span className="faint small">{kindWords(v)}</span>
      </span>
      <Combo
        label={v.name}
        placeholder={needWords(v)}
        text={isText(v)}
        live={props.live ?? false}
        value={props.values[v.name] ?? ""}
        onChange={(value) => props.onChange({ ...props.values, [v.name]: value })}
        choices={ofClass(props.vocabulary, v.type).map((t) => ({
          value: t.term,
          label: t.label,
          use: t.use,
        }))}
      />
    </div>
  ));
}

export function StartDialog(props: {
  workflow: string;
  flow: string;
  variables: readonly StartVariable[];
  vocabulary: Vocabulary;
  prefixes: ReadonlyMap<string, string>;
  onClose: () => void;
}) {
  const [values, setValues] = useState<Record<string, string>>({});
  const [busy, setBusy] = useState(false);
  const [error, setError] = useState<PlainError | null>(null);
  const { variables } = props;
  const needed = variables.filter((v) => v.need === "needed");
  const found = variables.filter((v) => v.need === "found");
  const lacks = needed.filter((v) => !(values[v.name] ?? "").trim());
  const start = async () => {
    setBusy(true);
    try {
      const reply = await workflows.start({
        workflow: props.workflow,
        flow: props.flow,
        variables: startArguments(values, props.prefixes, variables),
        requestId: randomUuid(),
      });
      toast("good", "The run has begun", runWords(reply.run));
      props.onClose();
      navigate(paths.run(reply.run));
    } catch (failure) {
      setError(
        failure instanceof RangeError
          ? { kind: "refused", title: "A value can't be read", detail: failure.message }
          : plain(failure),
      );
      setBusy(false);
    }
  };
  return (
    <Dialog label="Start a run" width={480} onClose={props.onClose}>
      <div className="sheet-head">
        <h2 className="grow">Start {props.workflow}</h2>
        <button className="button plain icon small" aria-label="Close" onClick={props.onClose}>
          <X size={15} />
        </button>
      </div>
      <div className="sheet-body" style={{ display: "grid", gap: "var(--space-5)" }}>
        <p className="quiet">
          {needed.length > 0 ? `It needs ${listed(needed)}.` : "It needs no values."}
          {found.length > 0 &&
            ` ${listed(found).replace(/^./, (c) => c.toUpperCase())} ${found.length === 1 ? "is" : "are"} found by its conditions, where nothing is given.`}
        </p>
        <StartFields
          variables={variables}
          values={values}
          vocabulary={props.vocabulary}
          live
          onChange={setValues}
        />
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
        <button className="button" onClick={props.onClose}>
          Cancel
        </button>
        <button
          className="button primary"
          disabled={busy || lacks.length > 0}
          title={lacks[0] ? `${words(lacks[0].name)} is missing` : undefined}
          onClick={() => void start()}
        >
          <Play size={13} />
          Start
        </button>
      </div>
    </Dialog>
  );
}
