// The properties of what is selected: a step, a link, several steps, or the flow itself.
import { ChevronDown, Copy, Plus, Trash2, X } from "lucide-react";
import { useEffect, useRef, useState, type ReactNode, type Ref } from "react";
import { shorten } from "../api/sparql";
import {
  type CawlDocument,
  type Flow,
  type Invoke,
  type Link,
  prefixesOf,
  type Step,
  type Variable,
} from "../cawl/document";
import { Edits, type LinkKind } from "../cawl/edits";
import { words } from "../cawl/names";
import { sourceOf } from "../cawl/called";
import { shownValue, writtenValue } from "../cawl/values";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";
import { Combo, type Choice } from "../ui/combo";
import { toast } from "../ui/toasts";
import type { Actions } from "./actions";
import { type CalledFlows, givesOf } from "./called_flows";
import { ConditionEditor } from "./condition_editor";
import type { Finding } from "./findings";
import { FindingRow } from "./findings_panel";
import { Inputs } from "./inputs";
import { type PaletteEntry, withInputs } from "../flow/palette_data";
import type { Session } from "./session";
import { KindIcon } from "../flow/step_card";
import type { Trial } from "./trials";
import { TryStep } from "./try_step";
import { ofClass, type Vocabulary } from "../facts/vocabulary";
import "./properties.css";

export interface PropertiesProps {
  session: Session;
  document: CawlDocument;
  flow: Flow;
  steps: readonly Step[];
  links: readonly Link[];
  actions: Actions;
  findings: readonly Finding[];
  compiled: readonly CompiledCondition[];
  palette: readonly PaletteEntry[];
  called: CalledFlows; // that steps of the document run
  vocabulary: Vocabulary;
  onFix: (finding: Finding) => void;
  onJump: (finding: Finding) => void;
  onCopy: () => void;
  runs: readonly Trial[]; // that a step can be tried on
  nameField: Ref<HTMLInputElement>; // of a step
}

export function Properties(props: PropertiesProps) {
  const [step] = props.steps;
  const [link] = props.links;
  if (props.steps.length + props.links.length > 1) return <Several {...props} />;
  if (step) return <StepProperties key={step.key} {...props} step={step} />;
  if (link) return <LinkProperties key={link.key} {...props} link={link} />;
  return <FlowProperties {...props} />;
}

// A field that is done when it is left or by Enter; Escape takes back what was typed.
export function Field(props: {
  ref?: Ref<HTMLInputElement>; // of one line
  label: string;
  value: string;
  onDone: (value: string) => void;
  placeholder?: string;
  lines?: number;
  hint?: string;
  hideLabel?: boolean;
}) {
  const [typed, setTyped] = useState(props.value);
  const value = useRef(props.value);
  value.current = props.value;
  useEffect(() => setTyped(props.value), [props.value]);
  const done = () => {
    if (typed === props.value) return;
    props.onDone(typed);
    window.setTimeout(() => setTyped(value.current)); // what was refused does not stay
  };
  const common = {
    className: "field",
    value: typed,
    placeholder: props.placeholder,
    "aria-label": props.label,
    onBlur: done,
    onChange: (e: React.ChangeEvent<HTMLInputElement | HTMLTextAreaElement>) => setTyped(e.target.value),
    onKeyDown: (e: React.KeyboardEvent) => {
      if (e.key === "Enter" && (!props.lines || e.ctrlKey)) done();
      if (e.key !== "Escape") return;
      e.stopPropagation();
      setTyped(props.value);
    },
  };
  return (
    <label className="property">
      {!props.hideLabel && <span>{props.label}</span>}
      {props.lines ? <textarea rows={props.lines} {...common} /> : <input ref={props.ref} {...common} />}
      {props.hint && <small className="faint">{props.hint}</small>}
    </label>
  );
}

function Section(props: { title: string; children: ReactNode; folded?: boolean }) {
  const [open, setOpen] = useState(!props.folded);
  return (
    <section className="property-section">
      <h2>
        <button aria-expanded={open} onClick={() => setOpen(!open)}>
          <ChevronDown size={13} />
          {props.title}
        </button>
      </h2>
      {open && <div className="property-body">{props.children}</div>}
    </section>
  );
}

function Mine({
  findings,
  onFix,
  onJump,
}: { findings: readonly Finding[] } & Pick<PropertiesProps, "onFix" | "onJump">) {
  if (findings.length === 0) return null;
  return (
    <ul className="property-findings">
      {findings.map((f) => (
        <FindingRow key={f.id} finding={f} onFix={onFix} onJump={onJump} />
      ))}
    </ul>
  ); // below: what stands above keeps its place when one comes
}

function StepProperties(props: PropertiesProps & { step: Step }) {
  const { step, flow, session, actions, document } = props;
  const edit = (make: (edits: Edits) => void) => session.edit(flow.key, make);
  const ext = (local: string) => (value: string) => edit((e) => e.setExt(step.element, local, value.trim()));
  const variables = [...document.variables, ...flow.variables];
  const prefixes = prefixesOf(document);
  const add = (id: string) => {
    const entry = props.palette.find((p) => p.id === id);
    if (entry) void withInputs(entry).then((whole) => actions.addInvoke(step, whole));
    else if (id) edit((e) => e.addInvoke(step, "operation", id));
  };
  const what: Choice[] = props.palette.map((p) => ({
    value: p.id,
    label: p.title === p.id ? p.detail : p.title,
    group: p.kind === "workflow" ? "Workflows" : p.kind === "service" ? "Services" : "Operations",
  }));
  return (
    <div className="properties" aria-label={`Properties of ${step.name}`}>
      <header className="properties-head">
        <span className="tag accent">
          {step.kind === "node" ? "Step" : step.kind === "source" ? "Begin" : "End"}
        </span>
        <Field
          ref={props.nameField}
          label="Name"
          hideLabel
          value={step.name}
          onDone={(name) => actions.rename(step, name)}
        />
        {step.kind === "node" && (
          <button className="button plain icon small" title="Copy" aria-label="Copy" onClick={props.onCopy}>
            <Copy size={14} />
          </button>
        )}
        <button
          className="button plain icon small"
          title="Remove"
          aria-label="Remove"
          onClick={() => actions.remove([step.key], [])}
        >
          <Trash2 size={14} />
        </button>
      </header>
      {step.kind === "node" && (
        <>
          <Section title="Opens when">
            <ConditionEditor
              document={document}
              part={step}
              place={`flow ${flow.name} / node ${step.name}`}
              variables={variables}
              compiled={props.compiled}
              vocabulary={props.vocabulary}
              edit={edit}
              firstWords={
                variables.some((v) => v.name === "user")
                  ? { subject: "$user", verb: "docent:isAt", object: "?place" }
                  : {
                      subject: "?robot",
                      verb: "docent:status",
                      object: "docent:Standby",
                      subjectType: "docent:Robot",
                    }
              }
            />
          </Section>
          <Section title="Does">
            {step.invokes.length === 0 && (
              <p className="faint small">Nothing yet: it is done as soon as it opens.</p>
            )}
            {step.invokes.map((invoke, i) => {
              const entry = entryOf(props, invoke);
              const source = (input: { name: string }) =>
                sourceOf(document, flow, step, input.name, givesOf(props.palette, props.called));
              return (
                <div key={i} className="invoke">
                  <KindIcon kind={invoke.kind === "subflow" ? "workflow" : (entry?.kind ?? "operation")} />
                  <Combo
                    label="What it does"
                    value={invoke.target}
                    choices={what}
                    onChange={(value) =>
                      edit((e) =>
                        value
                          ? e.setInvoke(
                              invoke,
                              props.palette.find((p) => p.id === value)?.kind === "workflow"
                                ? "subflow"
                                : "operation",
                              value,
                            )
                          : e.removeElement(invoke.element),
                      )
                    }
                  />
                  <button
                    className="button plain icon small"
                    aria-label={`Remove ${invoke.target}`}
                    title="Remove"
                    onClick={() => edit((e) => e.removeElement(invoke.element))}
                  >
                    <X size={13} />
                  </button>
                  {entry && entry.inputs.length > 0 && (
                    <Inputs
                      entry={entry}
                      invoke={invoke}
                      variables={variables}
                      vocabulary={props.vocabulary}
                      short={(iri) => shorten(iri, prefixes)}
                      {...(invoke.kind === "subflow" && { source })}
                      onSet={(input, expression) => actions.setInput(invoke, input, expression)}
                    />
                  )}
                </div>
              );
            })}
            <Combo
              label="Add something to do"
              placeholder="Add an operation, service or workflow"
              value=""
              choices={what}
              onChange={add}
            />
          </Section>
          <Section title="Try without a robot" folded>
            <TryStep
              document={document}
              flow={flow.name}
              step={step}
              place={`flow ${flow.name} / node ${step.name}`}
              variables={variables}
              compiled={props.compiled}
              palette={props.palette}
              runs={props.runs}
              text={session.written}
            />
          </Section>
          <Section
            title="More"
            folded={!(step.timeout || step.retry || step.forEach || step.whileHolds || step.documentation)}
          >
            <Field
              label="Description"
              lines={2}
              value={step.documentation}
              placeholder="What happens here, for people"
              onDone={(text) => edit((e) => e.setDocumentation(step, text))}
            />
            <div className="property-pair">
              <Field label="Ends after" value={step.timeout} placeholder="5min" onDone={ext("timeout")} />
              <Field label="Tries again" value={step.retry} placeholder="0 times" onDone={ext("retry")} />
            </div>
            <div className="property-pair">
              <Field
                label="Once for each"
                value={step.forEach}
                placeholder="?booth"
                onDone={ext("forEach")}
              />
              <Field
                label="Only while"
                value={step.whileHolds}
                placeholder="$user docent:isNear $robot"
                onDone={ext("while-holds")}
              />
            </div>
          </Section>
        </>
      )}
      <Mine
        findings={props.findings.filter((f) => f.flow === flow.key && f.step === step.key)}
        onFix={props.onFix}
        onJump={props.onJump}
      />
      {step.kind !== "node" && (
        <p className="property-note faint small">
          {step.kind === "source" ? "The run begins here." : "The run is done when it comes here."}
        </p>
      )}
    </div>
  );
}

// What an invoke does; a flow with the values that it takes.
function entryOf(
  { palette, called }: Pick<PropertiesProps, "palette" | "called">,
  invoke: Invoke,
): PaletteEntry | undefined {
  const entry = palette.find(
    (p) => p.id === invoke.target && (p.kind === "workflow") === (invoke.kind === "subflow"),
  );
  if (invoke.kind !== "subflow") return entry;
  const takes = called.get(invoke.target)?.takes;
  return takes
    ? {
        kind: "workflow",
        id: invoke.target,
        title: entry?.title ?? words(invoke.target),
        detail: "",
        inputs: takes,
      }
    : entry;
}

const kinds: { kind: LinkKind; title: string; hint: string }[] = [
  { kind: "plain", title: "Always", hint: "Followed when the step is done, if no link with a condition is." },
  { kind: "while", title: "While", hint: "Followed if this holds when the step is done. It may lead back." },
  { kind: "failure", title: "If it fails", hint: "Followed when the step fails, and only then." },
  { kind: "interrupt", title: "If interrupted", hint: "Followed when what has to hold meanwhile ceases to." },
];

function LinkProperties(props: PropertiesProps & { link: Link }) {
  const { link, session, flow, actions } = props;
  const edit = (make: (edits: Edits) => void) => session.edit(flow.key, make);
  return (
    <div className="properties" aria-label={`Link from ${link.from} to ${link.to}`}>
      <header className="properties-head">
        <span className="tag accent">Link</span>
        <span className="grow cut">
          {link.from} → {link.to}
        </span>
        <button
          className="button plain icon small"
          title="Remove"
          aria-label="Remove"
          onClick={() => actions.remove([], [link.key])}
        >
          <Trash2 size={14} />
        </button>
      </header>
      <Section title="Followed">
        <div className="segments" role="radiogroup" aria-label="When the link is followed">
          {kinds.map((k) => (
            <button
              key={k.kind}
              role="radio"
              aria-checked={link.kind === k.kind}
              onClick={() =>
                edit((e) => e.setLinkKind(link, k.kind, link.whileText || "?user docent:isAt ?place"))
              }
            >
              {k.title}
            </button>
          ))}
        </div>
        <p className="faint small">{kinds.find((k) => k.kind === link.kind)?.hint}</p>
        {link.kind === "while" && (
          <Field
            label="Subject, verb, object"
            value={link.whileText}
            onDone={(text) => edit((e) => e.setExt(link.element, "while", text.trim()))}
          />
        )}
      </Section>
      <Mine
        findings={props.findings.filter((f) => f.flow === flow.key && f.link === link.key)}
        onFix={props.onFix}
        onJump={props.onJump}
      />
    </div>
  );
}

function Several(props: PropertiesProps) {
  const { steps, links, actions } = props;
  return (
    <div className="properties">
      <header className="properties-head">
        <span className="grow">
          {[
            steps.length > 0 && `${steps.length} step${steps.length > 1 ? "s" : ""}`,
            links.length > 0 && `${links.length} link${links.length > 1 ? "s" : ""}`,
          ]
            .filter(Boolean)
            .join(" and ")}
        </span>
      </header>
      <div className="property-body row" style={{ padding: "0 var(--space-7) var(--space-7)" }}>
        <button className="button small" onClick={props.onCopy}>
          <Copy size={13} />
          Copy
        </button>
        <button
          className="button small danger"
          onClick={() =>
            actions.remove(
              steps.map((s) => s.key),
              links.map((l) => l.key),
            )
          }
        >
          <Trash2 size={13} />
          Remove
        </button>
      </div>
    </div>
  );
}

function FlowProperties(props: PropertiesProps) {
  const { document, flow, session } = props;
  const { activator, root } = document;
  const [variable, setVariable] = useState("");
  const edit = (make: (edits: Edits) => void) => session.edit(flow.key, make);
  const starts = activator?.flow === flow.name;
  const variables = [...document.variables, ...flow.variables];
  const classes: Choice[] = props.vocabulary.classes.map((w) => ({
    value: w.term,
    label: w.label,
    use: w.use,
  }));
  const begin = (v: Variable, typed: string) => {
    try {
      const colon = v.type.indexOf(":");
      const value = writtenValue(
        typed,
        colon > 0 ? (prefixesOf(document).get(v.type.slice(0, colon)) ?? "") + v.type.slice(colon + 1) : "",
      );
      edit((e) => e.setInitial(flow, v.name, value));
    } catch (error) {
      toast("bad", `${words(v.name)} stays as it was`, error instanceof Error ? error.message : "");
    }
  };
  return (
    <div className="properties" aria-label={`Properties of ${flow.name}`}>
      <header className="properties-head">
        <span className="tag accent">Workflow</span>
        <span className="grow cut" style={{ fontWeight: 600 }}>
          {document.name}
        </span>
      </header>
      <Section title="Starts by itself when">
        {starts && activator ? (
          <ConditionEditor
            document={document}
            part={activator}
            place={`activator ${activator.name}`.trim()}
            variables={[...document.variables, ...activator.variables]}
            compiled={props.compiled}
            vocabulary={props.vocabulary}
            edit={edit}
            firstWords={{
              subject: "?user",
              verb: "docent:chose",
              object: "?service",
              subjectType: "docent:Visitor",
            }}
          />
        ) : (
          <div className="condition-none">
            <p className="faint small">
              {activator
                ? `Only the flow ${activator.flow} starts by itself.`
                : "Never: it is started by hand, or as a step of another workflow."}
            </p>
            {!activator && (
              <button
                className="button small"
                onClick={() =>
                  edit((e) =>
                    e.addActivator(flow, {
                      subject: "?user",
                      verb: "docent:chose",
                      object: "?service",
                      subjectType: "docent:Visitor",
                    }),
                  )
                }
              >
                <Plus size={13} />
                Start when something holds
              </button>
            )}
          </div>
        )}
      </Section>
      <Section title="Values of a run">
        {variables.length === 0 && (
          <p className="faint small">None yet. Steps take what they need from here, by name.</p>
        )}
        {variables.map((v) => (
          <div key={`${v.name} ${v.element.from}`} className="variable">
            <code className="cut">${v.name}</code>
            <Combo
              label={`Kind of ${v.name}`}
              placeholder="any kind"
              value={v.type}
              choices={classes}
              onChange={(type) => edit((e) => e.set(v.element, "type", type || null))}
            />
            <button
              className="button plain icon small"
              aria-label={`Remove ${v.name}`}
              title="Remove"
              onClick={() => edit((e) => e.removeElement(v.element))}
            >
              <X size={13} />
            </button>
            {v.initial && flow.variables.includes(v) && (
              <label className="variable-initial">
                <span className="faint">begins as</span>
                <Combo
                  label={`First value of ${v.name}`}
                  value={shownValue(v.initial)}
                  text={v.type === "xsd:string"}
                  choices={
                    v.type.startsWith("xsd:")
                      ? []
                      : ofClass(props.vocabulary, v.type).map((w) => ({
                          value: w.term,
                          label: w.label,
                          use: w.use,
                        }))
                  }
                  onChange={(typed) => begin(v, typed)}
                />
              </label>
            )}
          </div>
        ))}
        <form
          className="variable"
          onSubmit={(e) => {
            e.preventDefault();
            if (!/^[A-Za-z]\w*$/.test(variable)) return;
            edit((x) => x.addVariable(flow, variable));
            setVariable("");
          }}
        >
          <input
            className="field small"
            placeholder="new value, e.g. booth"
            aria-label="Name of a new value"
            value={variable}
            onChange={(e) => setVariable(e.target.value.replace(/\W/g, ""))}
          />
          <button
            className="button small"
            disabled={!/^[A-Za-z]\w*$/.test(variable) || variables.some((v) => v.name === variable)}
          >
            <Plus size={13} />
            Add
          </button>
        </form>
      </Section>
      <Section title="Document" folded>
        <div className="property-pair">
          <Field
            label="Version"
            value={document.version}
            placeholder="1.0"
            onDone={(value) => root && edit((e) => e.set(root, "version", value.trim() || null))}
          />
          <Field
            label="Flow"
            value={flow.name}
            onDone={(value) => edit((e) => e.renameFlow(document, flow, value))}
          />
        </div>
        <p className="faint small">
          {flow.steps.filter((s) => s.kind === "node").length} steps, {flow.links.length} links.{" "}
          {words(document.name)} is deployed under the name {document.name}.
        </p>
      </Section>
      <Mine
        findings={props.findings
          .filter((f) => (!f.step && !f.link) || (starts && f.rule === "unset-input" && f.flow === flow.key))
          .slice(0, 4)}
        onFix={props.onFix}
        onJump={props.onJump}
      />
    </div>
  );
}
