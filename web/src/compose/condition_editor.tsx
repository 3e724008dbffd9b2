// What has to hold, as rows of subject, verb and object, each with its state in the live graph.
import { Ban, Circle, Clock3, Plus, Trash2, X } from "lucide-react";
import { useMemo, useState } from "react";
import {
  type CawlDocument,
  type Condition,
  type Constraint,
  type Context,
  type Invoke,
  prefixesOf,
  type Rule,
} from "../cawl/document";
import { conditionLogic, ruleLogic, senseInRule, senseOfContext } from "../cawl/condition_logic";
import type { Edits, Words } from "../cawl/edits";
import type { Sense } from "../cawl/expression";
import { logicWords, timeWords } from "../cawl/phrases";
import type { CompiledCondition } from "../gen/docent/v1/workflows_pb";
import { Combo, type Choice } from "../ui/combo";
import type { XmlElement } from "../cawl/xml";
import { Chip, count, Miss, RowState } from "./condition_states";
import { constraintAsk, ofKinds, useLive, type Live } from "./live";
import {
  ofClass,
  useVerbsOfClasses,
  verbsFor,
  verbWordsToFind,
  type Vocabulary,
  type Word,
} from "../facts/vocabulary";
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
  const rows =
    condition?.contexts.flatMap((context, c) =>
      context.rules.flatMap((rule, r) =>
        rule.constraints.map((constraint, k) => ({ id: `${c}.${r}.${k}`, constraint })),
      ),
    ) ?? [];
  const asks = [
    ...rows.map(({ id, constraint }) => ({ id, ask: constraintAsk(props.document, constraint) })),
    ...(condition ? situationAsks(props.compiled, props.place, condition) : []),
  ];
  const kinds = new Map(
    props.variables.filter((v) => v.type && !v.type.startsWith("xsd:")).map((v) => [v.name, v.type]),
  );
  const live = useLive(
    props.document,
    asks.map((a) => ({ ...a, ask: ofKinds(props.document, a.ask, rowsOf(a.id, rows), kinds) })),
  );
  const choices = useChoices(props);
  const prefixes = useMemo(() => prefixesOf(props.document), [props.document]);
  const used = useVerbsOfClasses(
    rows.map(({ constraint }) => classOf(constraint.subject, props)).filter(Boolean),
    prefixes,
  );
  if (!condition)
    return (
      <div className="condition-none">
        <p className="faint small">No condition: it opens as soon as its turn comes.</p>
        <button
          className="button small"
          onClick={() => props.edit((e) => e.addCondition(props.part, props.firstWords))}
        >
          <Plus size={13} />
          Wait for a situation
        </button>
      </div>
    );
  return (
    <div className="condition">
      {condition.expression && (
        <Together condition={condition} live={live.get(togetherId)} document={props.document} />
      )}
      {condition.events.map((event) => (
        <div key={event} className="condition-event">
          <Circle size={12} />
          event <b>{event}</b>
        </div>
      ))}
      {condition.contexts.map((context, c) => (
        <div key={c}>
          {c > 0 && !condition.expression && <div className="condition-or">or</div>}
          <ContextCard
            {...props}
            condition={condition}
            context={context}
            index={c}
            live={live}
            choices={choices}
            used={used}
          />
        </div>
      ))}
      <button
        className="button plain small"
        onClick={() => props.edit((e) => e.addContext(condition, props.firstWords))}
      >
        <Plus size={13} />
        Or another situation
      </button>
    </div>
  );
}

// An expression over situations: what holds is asked of all together.
function Together({
  condition,
  live,
  document,
}: {
  condition: Condition;
  live: Live | undefined;
  document: CawlDocument;
}) {
  return (
    <section
      className={`situation${live && live.matches > 0 ? " holds" : ""}`}
      aria-label="All situations together"
    >
      <header>
        <Chip live={live} />
        <span className="cut grow situation-name" title={condition.expression}>
          {logicWords(conditionLogic(condition))}
        </span>
      </header>
      {live && live.matches === 0 && live.miss && <Miss miss={live.miss} name="" document={document} />}
    </section>
  );
}

export const togetherId = "together";
// The asks of whole situations, or of their expression. The server names a situation without a name by its number.
export function situationAsks(
  compiled: readonly CompiledCondition[],
  place: string,
  condition: Condition,
): { id: string; ask: string }[] {
  if (condition.expression)
    return [
      { id: togetherId, ask: compiled.find((x) => x.place.startsWith(`${place} / condition`))?.ask ?? "" },
    ];
  return condition.contexts.map((context, c) => ({
    id: `${c}`,
    ask: compiled.find((x) => x.place === `${place} / context ${context.name || c + 1}`)?.ask ?? "",
  }));
}

// The rows that an ask is made of: one, or all of a situation, or of all together.
export function rowsOf(id: string, rows: readonly { id: string; constraint: Constraint }[]): Constraint[] {
  return rows
    .filter((row) => id === togetherId || row.id === id || row.id.startsWith(`${id}.`))
    .map((row) => row.constraint);
}

interface Choices {
  subjects: Choice[];
  objects: Choice[];
  classes: Choice[];
}

function useChoices(props: ConditionProps): Choices {
  const { vocabulary, variables } = props;
  return useMemo(() => {
    const own = variables.flatMap((v): Choice[] => [
      { value: `$${v.name}`, label: v.type, group: "Values of the run" },
    ]);
    const free = ["?robot", "?user", "?booth"].map((value): Choice => ({
      value,
      label: "any that fits",
      group: "Found by the match",
    }));
    const things = vocabulary.things.map(thingChoice);
    return {
      subjects: [...own, ...free, ...things],
      objects: [
        ...own,
        ...free,
        { value: "true", group: "Values" },
        { value: "> 0", label: "more than", group: "Values" },
        ...things,
      ],
      classes: vocabulary.classes.map((w) => ({ value: w.term, label: w.label, use: w.use })),
    };
  }, [vocabulary, variables]);
}

// Of which class a subject is, as far as the document or the graph says; empty: not known.
function classOf(
  slot: { text: string; type: string },
  props: Pick<ConditionProps, "part" | "variables" | "vocabulary">,
): string {
  if (slot.type) return slot.type;
  const text = slot.text.trim();
  if (!/^[?$]/.test(text)) return props.vocabulary.things.find((t) => t.term === text)?.classes?.[0] ?? "";
  const same = (other: string) => other.trim().slice(1) === text.slice(1) && /^[?$]/.test(other.trim());
  const told = props.part.condition?.contexts
    .flatMap((c) => c.rules.flatMap((r) => r.constraints.flatMap((k) => [k.subject, k.object])))
    .find((s) => s.type && same(s.text))?.type;
  return told ?? props.variables.find((v) => v.name === text.slice(1))?.type ?? "";
}

const thingChoice = (w: Word): Choice => ({
  value: w.term,
  label: w.label || w.use,
  use: w.use,
  group: "In the graph now",
});

type CardProps = ConditionProps & {
  condition: Condition;
  context: Context;
  index: number;
  live: ReadonlyMap<string, Live>;
  choices: Choices;
  used: ReadonlyMap<string, ReadonlyMap<string, number>>;
};

function ContextCard(props: CardProps) {
  const { condition, context, index, live, edit } = props;
  const whole = live.get(`${index}`);
  const rules = context.rules;
  const sense = senseOfContext(condition, context);
  return (
    <section
      className={`situation${whole && whole.matches > 0 ? " holds" : ""}`}
      aria-label={`Situation ${context.name}`}
    >
      <header>
        {!condition.expression && <Chip live={whole} />}
        <span className="cut grow situation-name">{context.name || "Situation"}</span>
        <SenseTag sense={sense} />
        <button
          className="button plain icon small"
          aria-label={`Remove the situation ${context.name}`}
          title="Remove this situation"
          onClick={() => edit((e) => e.removeContext(condition, context))}
        >
          <Trash2 size={13} />
        </button>
      </header>
      {rules.map((rule, r) => (
        <RuleRows key={r} {...props} rule={rule} ruleIndex={r} />
      ))}
      <footer>
        <button
          className="button plain small"
          onClick={() =>
            edit((e) =>
              e.addConstraint(context, rules.at(-1) ?? null, {
                subject: rules.at(-1)?.constraints.at(-1)?.subject.text || "?thing",
                verb: "docent:isAt",
                object: "?place",
              }),
            )
          }
        >
          <Plus size={13} />
          And also
        </button>
      </footer>
      {whole && whole.matches > 0 && (
        <p className="situation-witness" role="status">
          <b>{count(whole.matches)} now</b>
          {whole.witness && (
            <>
              {whole.matches === 1 ? ": " : ", one is "}
              {whole.witness}
            </>
          )}
        </p>
      )}
      {whole && whole.matches === 0 && whole.miss && (
        <Miss miss={whole.miss} name={context.name} document={props.document} />
      )}
    </section>
  );
}

function RuleRows(props: CardProps & { rule: Rule; ruleIndex: number }) {
  const { rule, ruleIndex, index, edit } = props;
  return (
    <div className="situation-rule">
      {(rule.lasting || rule.expression) && (
        <div className="situation-also">
          {rule.lasting && (
            <label className="row">
              <Clock3 size={12} />
              without a break for
              <input
                className="field small"
                style={{ width: 70 }}
                defaultValue={rule.lasting}
                key={rule.lasting}
                aria-label="How long it has to hold"
                onBlur={(e) =>
                  e.target.value !== rule.lasting &&
                  edit((x) => x.setExt(rule.element, "for", e.target.value.trim()))
                }
              />
            </label>
          )}
          {rule.expression && (
            <span className="cut" title={logicWords(ruleLogic(rule))}>
              where <code>{rule.expression}</code>
            </span>
          )}
        </div>
      )}
      {[...props.rule.times, ...(ruleIndex === 0 ? props.context.times : [])].map((time, k) => (
        <div key={`t${k}`} className="condition-event">
          <Clock3 size={12} />
          {timeWords(time)}
        </div>
      ))}
      {rule.constraints.map((constraint, k) => (
        <ConstraintRow
          key={k}
          {...props}
          constraint={constraint}
          state={props.live.get(`${index}.${ruleIndex}.${k}`)}
        />
      ))}
    </div>
  );
}

function ConstraintRow(props: CardProps & { rule: Rule; constraint: Constraint; state: Live | undefined }) {
  const { constraint, edit, choices, state } = props;
  const sense = senseInRule(props.rule, constraint);
  const [kinds, setKinds] = useState(false);
  const set = (which: "subject" | "verb" | "object") => (value: string) =>
    edit((e) => e.setSlot(constraint, which, value));
  const setType = (which: "subject" | "object") => (value: string) =>
    edit((e) => e.setSlot(constraint, which, constraint[which].text, value));
  const typed = constraint.subject.type || constraint.object.type;
  // Of the kind that the row says, where it says one.
  const offered = (which: "subject" | "object", all: readonly Choice[]) =>
    constraint[which].type
      ? [
          ...all.filter((c) => c.group !== "In the graph now"),
          ...ofClass(props.vocabulary, constraint[which].type).map(thingChoice),
        ]
      : all;
  const type = classOf(constraint.subject, props);
  const used = props.used.get(type);
  const verbs = useMemo(
    () => [
      { value: "a", label: "is a" },
      ...verbsFor(props.vocabulary, type, used).map((w): Choice => ({
        value: w.term,
        label: w.label,
        use: w.use,
        words: verbWordsToFind(w),
      })),
    ],
    [props.vocabulary, type, used],
  );
  return (
    <div className="constraint">
      <SenseTag sense={sense} />
      <div className="constraint-words">
        <Combo
          label="Subject"
          placeholder="who or what"
          value={constraint.subject.text}
          choices={offered("subject", choices.subjects)}
          onChange={set("subject")}
        />
        <Combo
          label="Verb"
          placeholder="is or has"
          value={constraint.verb.text}
          choices={verbs}
          onChange={set("verb")}
          className="verb"
        />
        <Combo
          label="Object"
          placeholder="what"
          value={constraint.object.text}
          choices={constraint.verb.text === "a" ? choices.classes : offered("object", choices.objects)}
          onChange={set("object")}
        />
        <button
          className="button plain icon small"
          aria-label="Remove this row"
          title="Remove this row"
          onClick={() =>
            edit((e) => e.removeConstraint(props.condition, props.context, props.rule, constraint))
          }
        >
          <X size={13} />
        </button>
      </div>
      <div className="constraint-foot">
        <RowState live={state} constraint={constraint} document={props.document} sense={sense} />
        {!kinds && (
          <button className="constraint-kinds" onClick={() => setKinds(true)}>
            {typed ? kindWords(constraint) : "say the kind"}
          </button>
        )}
      </div>
      {kinds && (
        <div className="constraint-types">
          <span className="faint small">kinds</span>
          <Combo
            label="Kind of the subject"
            placeholder="of the subject"
            value={constraint.subject.type}
            choices={choices.classes}
            onChange={setType("subject")}
          />
          <Combo
            label="Kind of the object"
            placeholder="of the object"
            value={constraint.object.type}
            choices={choices.classes}
            onChange={setType("object")}
          />
          <button
            className="button plain icon small"
            aria-label="Close the kinds"
            onClick={() => setKinds(false)}
          >
            <X size={13} />
          </button>
        </div>
      )}
    </div>
  );
}

function kindWords(constraint: Constraint): string {
  const one = (slot: { text: string; type: string }) => (slot.type ? `${slot.text} is a ${slot.type}` : "");
  return [one(constraint.subject), one(constraint.object)].filter(Boolean).join(", ");
}

// Of a row or situation that has not simply to be there. Undefined: the expression does not name it.
function SenseTag({ sense }: { sense: Sense | undefined }) {
  if (sense === "must") return null;
  return (
    <span className="tag condition-sense">
      {sense === "must not" ? (
        <>
          <Ban size={11} />
          must not be
        </>
      ) : sense === "both" ? (
        "in some ways, not in others"
      ) : (
        "not looked at"
      )}
    </span>
  );
}
