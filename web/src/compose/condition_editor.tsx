// What has to hold, as rows of subject, verb and object, each with its state in the live graph.
import { Circle, CircleCheck, CircleDashed, Clock3, FlaskConical, Plus, Trash2, X } from "lucide-react";
import { useMemo, useState } from "react";
import { useNames } from "../api/prefixes";
import { shorten } from "../api/sparql";
import { type CawlDocument, type Condition, type Constraint, type Context, type Invoke, prefixesOf, type Rule } from "../cawl/document";
import type { Edits, Words } from "../cawl/edits";
import { termWords, verbWords } from "../cawl/phrases";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";
import { Combo, type Choice } from "../ui/combo";
import type { XmlElement } from "../cawl/xml";
import { TellDialog } from "../operate/tell";
import { constraintAsk, matchesShown, ofKinds, useLive, type Live } from "./live";
import type { Lack, NearestMiss } from "./nearest_miss";
import { patternWords, termName, valuesWords } from "./term_name";
import { ofClass, useVerbsOfClasses, verbsFor, verbWordsToFind, type Vocabulary, type Word } from "./vocabulary";
import "./condition.css";

export interface ConditionProps {
  document: CawlDocument;
  part: { element: XmlElement; condition: Condition | null; invokes?: Invoke[] };
  place: string; // "flow F / node N": how the server names it
  variables: readonly { name: string; type: string }[];
  compiled: readonly CompiledCondition[];
  vocabulary: Vocabulary;
  edit: (make: (edits: Edits) => void) => void;
  firstWords: Words;
}

export function ConditionEditor(props: ConditionProps) {
  const { condition } = props.part;
  const rows = condition?.contexts.flatMap((context, c) => context.rules.flatMap((rule, r) => rule.constraints.map((constraint, k) => ({ id: `${c}.${r}.${k}`, constraint })))) ?? [];
  const asks = [
    ...rows.map(({ id, constraint }) => ({ id, ask: constraintAsk(props.document, constraint) })),
    ...(condition?.contexts ?? []).map((context, c) => ({ id: `${c}`, ask: askOf(props.compiled, props.place, context, c) })),
  ];
  const kinds = new Map(props.variables.filter((v) => v.type && !v.type.startsWith("xsd:")).map((v) => [v.name, v.type]));
  const live = useLive(props.document, asks.map((a) => ({ ...a, ask: ofKinds(props.document, a.ask, rowsOf(a.id, rows), kinds) })));
  const choices = useChoices(props);
  const prefixes = useMemo(() => prefixesOf(props.document), [props.document]);
  const used = useVerbsOfClasses(rows.map(({ constraint }) => classOf(constraint.subject, props)).filter(Boolean), prefixes);
  if (!condition)
    return (
      <div className="condition-none">
        <p className="faint small">No condition: it opens as soon as its turn comes.</p>
        <button className="button small" onClick={() => props.edit((e) => e.addCondition(props.part, props.firstWords))}><Plus size={13} />Wait for a situation</button>
      </div>
    );
  return (
    <div className="condition">
      {condition.events.map((event) => <div key={event} className="condition-event"><Circle size={12} />event <b>{event}</b></div>)}
      {condition.contexts.map((context, c) => (
        <div key={c}>
          {c > 0 && <div className="condition-or">or</div>}
          <ContextCard {...props} condition={condition} context={context} index={c} live={live} choices={choices} used={used} />
        </div>
      ))}
      <button className="button plain small" onClick={() => props.edit((e) => e.addContext(condition, props.firstWords))}><Plus size={13} />Or another situation</button>
    </div>
  );
}

// The ask of a whole situation. The server names a situation without a name by its number.
export function askOf(compiled: readonly CompiledCondition[], place: string, context: Context, index: number): string {
  return compiled.find((x) => x.place === `${place} / context ${context.name || index + 1}`)?.ask ?? "";
}

// The rows that an ask is made of: one, or all of a situation.
export function rowsOf(id: string, rows: readonly { id: string; constraint: Constraint }[]): Constraint[] {
  return rows.filter((row) => row.id === id || row.id.startsWith(`${id}.`)).map((row) => row.constraint);
}

interface Choices {
  subjects: Choice[];
  objects: Choice[];
  classes: Choice[];
}

function useChoices(props: ConditionProps): Choices {
  const { vocabulary, variables } = props;
  return useMemo(() => {
    const own = variables.flatMap((v): Choice[] => [{ value: `$${v.name}`, label: v.type, group: "Values of the run" }]);
    const free = ["?robot", "?user", "?booth"].map((value): Choice => ({ value, label: "any that fits", group: "Found by the match" }));
    const things = vocabulary.things.map(thingChoice);
    return {
      subjects: [...own, ...free, ...things],
      objects: [...own, ...free, { value: "true", group: "Values" }, { value: "> 0", label: "more than", group: "Values" }, ...things],
      classes: vocabulary.classes.map((w) => ({ value: w.term, label: w.label, use: w.use })),
    };
  }, [vocabulary, variables]);
}

// Of which class a subject is, as far as the document or the graph says; empty: not known.
function classOf(slot: { text: string; type: string }, props: Pick<ConditionProps, "part" | "variables" | "vocabulary">): string {
  if (slot.type) return slot.type;
  const text = slot.text.trim();
  if (!/^[?$]/.test(text)) return props.vocabulary.things.find((t) => t.term === text)?.classes?.[0] ?? "";
  const same = (other: string) => other.trim().slice(1) === text.slice(1) && /^[?$]/.test(other.trim());
  const told = props.part.condition?.contexts.flatMap((c) => c.rules.flatMap((r) => r.constraints.flatMap((k) => [k.subject, k.object]))).find((s) => s.type && same(s.text))?.type;
  return told ?? props.variables.find((v) => v.name === text.slice(1))?.type ?? "";
}

const thingChoice = (w: Word): Choice => ({ value: w.term, label: w.label || w.use, use: w.use, group: "In the graph now" });

type CardProps = ConditionProps & { condition: Condition; context: Context; index: number; live: ReadonlyMap<string, Live>; choices: Choices; used: ReadonlyMap<string, ReadonlyMap<string, number>> };

function ContextCard(props: CardProps) {
  const { condition, context, index, live, edit } = props;
  const whole = live.get(`${index}`);
  const rules = context.rules.length > 0 ? context.rules : [];
  return (
    <section className={`situation${whole && whole.matches > 0 ? " holds" : ""}`} aria-label={`Situation ${context.name}`}>
      <header>
        <Chip live={whole} />
        <span className="cut grow situation-name">{context.name || "Situation"}</span>
        <button className="button plain icon small" aria-label={`Remove the situation ${context.name}`} title="Remove this situation" onClick={() => edit((e) => e.removeContext(condition, context))}><Trash2 size={13} /></button>
      </header>
      {rules.map((rule, r) => <RuleRows key={r} {...props} rule={rule} ruleIndex={r} />)}
      <footer>
        <button className="button plain small" onClick={() => edit((e) => e.addConstraint(context, rules.at(-1) ?? null, { subject: rules.at(-1)?.constraints.at(-1)?.subject.text || "?thing", verb: "docent:isAt", object: "?place" }))}><Plus size={13} />And also</button>
      </footer>
      {whole && whole.matches > 0 && <p className="situation-witness" role="status"><b>{count(whole.matches)} now</b>{whole.witness && <>{whole.matches === 1 ? ": " : ", one is "}{whole.witness}</>}</p>}
      {whole && whole.matches === 0 && whole.miss && <Miss miss={whole.miss} name={context.name} document={props.document} />}
    </section>
  );
}

function RuleRows(props: CardProps & { rule: Rule; ruleIndex: number }) {
  const { rule, ruleIndex, index, edit } = props;
  return (
    <div className="situation-rule">
      {(rule.lasting || rule.expression) && (
        <div className="situation-also">
          {rule.lasting && <label className="row"><Clock3 size={12} />without a break for<input className="field small" style={{ width: 70 }} defaultValue={rule.lasting} key={rule.lasting} aria-label="How long it has to hold" onBlur={(e) => e.target.value !== rule.lasting && edit((x) => x.setExt(rule.element, "for", e.target.value.trim()))} /></label>}
          {rule.expression && <span className="cut" title={rule.expression}>where <code>{rule.expression}</code></span>}
        </div>
      )}
      {rule.constraints.map((constraint, k) => (
        <ConstraintRow key={k} {...props} constraint={constraint} state={props.live.get(`${index}.${ruleIndex}.${k}`)} />
      ))}
    </div>
  );
}

function ConstraintRow(props: CardProps & { rule: Rule; constraint: Constraint; state: Live | undefined }) {
  const { constraint, edit, choices, state } = props;
  const [kinds, setKinds] = useState(false);
  const set = (which: "subject" | "verb" | "object") => (value: string) => edit((e) => e.setSlot(constraint, which, value));
  const setType = (which: "subject" | "object") => (value: string) => edit((e) => e.setSlot(constraint, which, constraint[which].text, value));
  const typed = constraint.subject.type || constraint.object.type;
  // Of the kind that the row says, where it says one.
  const offered = (which: "subject" | "object", all: readonly Choice[]) => (constraint[which].type ? [...all.filter((c) => c.group !== "In the graph now"), ...ofClass(props.vocabulary, constraint[which].type).map(thingChoice)] : all);
  const type = classOf(constraint.subject, props);
  const used = props.used.get(type);
  const verbs = useMemo(() => [{ value: "a", label: "is a" }, ...verbsFor(props.vocabulary, type, used).map((w): Choice => ({ value: w.term, label: w.label, use: w.use, words: verbWordsToFind(w) }))], [props.vocabulary, type, used]);
  return (
    <div className="constraint">
      <div className="constraint-words">
        <Combo label="Subject" placeholder="who or what" value={constraint.subject.text} choices={offered("subject", choices.subjects)} onChange={set("subject")} />
        <Combo label="Verb" placeholder="is or has" value={constraint.verb.text} choices={verbs} onChange={set("verb")} className="verb" />
        <Combo label="Object" placeholder="what" value={constraint.object.text} choices={constraint.verb.text === "a" ? choices.classes : offered("object", choices.objects)} onChange={set("object")} />
        <button className="button plain icon small" aria-label="Remove this row" title="Remove this row" onClick={() => edit((e) => e.removeConstraint(props.condition, props.context, props.rule, constraint))}><X size={13} /></button>
      </div>
      <div className="constraint-foot">
        <RowState live={state} constraint={constraint} document={props.document} />
        {!kinds && <button className="constraint-kinds" onClick={() => setKinds(true)}>{typed ? kindWords(constraint) : "say the kind"}</button>}
      </div>
      {kinds && (
        <div className="constraint-types">
          <span className="faint small">kinds</span>
          <Combo label="Kind of the subject" placeholder="of the subject" value={constraint.subject.type} choices={choices.classes} onChange={setType("subject")} />
          <Combo label="Kind of the object" placeholder="of the object" value={constraint.object.type} choices={choices.classes} onChange={setType("object")} />
          <button className="button plain icon small" aria-label="Close the kinds" onClick={() => setKinds(false)}><X size={13} /></button>
        </div>
      )}
    </div>
  );
}

function kindWords(constraint: Constraint): string {
  const one = (slot: { text: string; type: string }) => (slot.type ? `${slot.text} is a ${slot.type}` : "");
  return [one(constraint.subject), one(constraint.object)].filter(Boolean).join(", ");
}

function count(matches: number): string {
  return matches >= matchesShown ? `${matchesShown} or more matches` : matches === 1 ? "1 match" : `${matches} matches`;
}

// The state of a whole situation, as icon and words.
function Chip({ live }: { live: Live | undefined }) {
  if (!live || live.matches < 0) return <span className="tag"><CircleDashed size={12} />not asked</span>;
  return live.matches > 0 ? <span className="tag good"><CircleCheck size={12} />true now</span> : <span className="tag wait"><Circle size={12} />not now</span>;
}

function RowState({ live, constraint, document }: { live: Live | undefined; constraint: Constraint; document: CawlDocument }) {
  if (!live) return <span className="constraint-state faint"><CircleDashed size={11} />…</span>;
  if (live.matches < 0) return <span className="constraint-state faint" title={live.note}><CircleDashed size={11} />can't be asked</span>;
  if (live.matches === 0) {
    const [lack] = live.miss?.lacks ?? [];
    const instead = lack?.now ? `: ${insteadWords(lack, prefixesOf(document))}` : "";
    return <span className="constraint-state none cut" title={`no match now${instead}`}><Circle size={11} /><span className="cut">no match now{instead}</span></span>;
  }
  const words = matchWords(constraint, live.found);
  return <span className="constraint-state some cut" title={live.witness}><CircleCheck size={11} /><span className="cut">{count(live.matches)}{words && `${live.matches === 1 ? ": " : ", one is "}${words}`}</span></span>;
}

// The row with what was found in the places of its variables: "R01 status Standby".
export function matchWords(constraint: Constraint, found: Readonly<Record<string, string>>): string {
  const word = (text: string) => found[text.trim().replace(/^[?$]/, "").replace(".", "_")] ?? termWords(text);
  const free = [constraint.subject.text, constraint.object.text].some((text) => /^[?$]/.test(text.trim()));
  if (!free) return "";
  return [/^[?$]/.test(constraint.subject.text.trim()) ? word(constraint.subject.text) : termWords(constraint.subject.text), verbWords(constraint.verb.text), /^[?$]/.test(constraint.object.text.trim()) ? word(constraint.object.text) : termWords(constraint.object.text)].join(" ");
}
// What is there in place of what is missing: "John is at B10".
function insteadWords({ pattern, now }: Lack, prefixes: ReadonlyMap<string, string>): string {
  const [subject = "", verb = ""] = pattern.split(" ");
  return `${termName(subject, prefixes)} ${verbWords(verb)} ${valuesWords(now, prefixes)}`;
}

// What is nearest to the situation, what is missing, and a way to try it.
function Miss({ miss, name, document }: { miss: NearestMiss; name: string; document: CawlDocument }) {
  const [telling, setTelling] = useState(false);
  const names = useNames();
  const prefixes = useMemo(() => new Map([...names.prefixes, ...prefixesOf(document)]), [names, document]);
  if (miss.lacks.length + miss.tooMuch.length === 0) return miss.text ? <p className="situation-lacks small">{miss.text}</p> : null;
  return (
    <div className="situation-lacks" role="status">
      {miss.where && <p>Nearest: {miss.where}{miss.holds > 0 && <span className="faint"> ({miss.holds === 1 ? "one fact of it is" : `${miss.holds} facts of it are`} there)</span>}</p>}
      <ul>
        {miss.lacks.map((lack, i) => <li key={i} title={lack.pattern}>missing: <b>{patternWords(lack.pattern, prefixes)}</b>{lack.now && <>, now {valuesWords(lack.now, prefixes)}</>}</li>)}
        {miss.tooMuch.map((text, i) => <li key={`x${i}`} title={text}>must not be: <b>{patternWords(text, prefixes)}</b></li>)}
      </ul>
      <p className="row">
        {miss.add.length > 0 && <button className="button small" onClick={() => setTelling(true)}><FlaskConical size={13} />Simulate or tell</button>}
        {miss.others > 0 && <span className="faint small">{miss.others === 1 ? "One other way is" : `${miss.others} other ways are`} as near</span>}
      </p>
      {telling && <TellDialog title={`What is missing for ${name || "the situation"}`} quads={miss.add} patterns={miss.lacks.map((l) => l.pattern)} names={{ ...names, prefixes, short: (iri) => shorten(iri, prefixes), name: names.name }} onClose={() => setTelling(false)} />}
    </div>
  );
}
