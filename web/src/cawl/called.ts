// What a flow takes from the run that runs it as a step, and what of that has a value before. Pure functions.
import { eachWayHas, neededRows } from "./condition_logic";
import { type CawlDocument, type Condition, type Flow, type Invoke, prefixesOf, type Step } from "./document";
import { literally } from "./names";
import { assigns, needOf, startFlow } from "./start_values";

export interface Taken {
  name: string;
  type: string; // IRI; empty: any
  optional?: boolean; // the run takes one that is free
  matched?: boolean; // a condition of the flow uses it: without a value, it matches whatever fits
}
// A flow as a step sees it.
export interface Called {
  takes: Taken[];
  gives: readonly string[]; // names of the values that the caller has afterwards
}

// The results of what an invoke does; undefined: not known, and may be any.
export type Gives = (invoke: Invoke) => readonly string[] | undefined;

// A flow of the document by its name; of no name: the one that a start by hand runs. Undefined: it has no such flow.
export function calledFlow(document: CawlDocument, flow: string, gives: Gives): Called | undefined {
  const found = flow ? document.flows.find((f) => f.name === flow) : startFlow(document);
  return found && { takes: takenBy(document, found, gives), gives: givenBy(document, found) };
}

// The flow's variables that nothing in it gives a value, and those of the document and its activator that it uses: a match of the
// activator is not there when a step runs the flow.
function takenBy(document: CawlDocument, flow: Flow, gives: Gives): Taken[] {
  const body = document.text.slice(flow.element.from, flow.element.to);
  const prefixes = prefixesOf(document);
  const outer = [...document.variables, ...(document.activator?.variables ?? [])].filter((v) =>
    uses(body, v.name),
  );
  const all = [...flow.variables, ...outer].filter(
    (v, i, list) => v.name && list.findIndex((w) => w.name === v.name) === i,
  );
  return all.flatMap((v): Taken[] => {
    const need = needOf(v, flow, document.text);
    if (
      (need !== "needed" && need !== "any") ||
      flow.steps.some((s) => s.invokes.some((i) => gives(i)?.includes(v.name)))
    )
      return [];
    const matched = flow.steps.some((s) => conditionTerms(s.condition).some((term) => term === `$${v.name}`));
    return [
      {
        name: v.name,
        type: iriOf(v.type, prefixes),
        ...(need === "any" && { optional: true }),
        ...(matched && { matched }),
      },
    ];
  });
}
function givenBy(document: CawlDocument, flow: Flow): string[] {
  const body = document.text.slice(flow.element.from, flow.element.to);
  const named = flow.element.children
    .filter((c) => c.local === "output")
    .map((c) => attributeOf(document.text.slice(c.from, c.openTo)));
  if (named.length > 0) return named;
  return [
    ...new Set([
      ...flow.variables.map((v) => v.name),
      ...[...body.matchAll(/\?([A-Za-z]\w*)/g)].map(([, name = ""]) => name),
    ]),
  ];
}
function attributeOf(tag: string): string {
  return (/\bpart=["']([^"']*)["']/.exec(tag) ?? /\bvariable=["']([^"']*)["']/.exec(tag))?.[1] ?? "";
}
function uses(body: string, name: string): boolean {
  return new RegExp(`\\$${literally(name)}(?![\\w-])`).test(body);
}
function iriOf(type: string, prefixes: ReadonlyMap<string, string>): string {
  const colon = type.indexOf(":");
  return colon > 0 ? (prefixes.get(type.slice(0, colon)) ?? "") + type.slice(colon + 1) : "";
}
function conditionTerms(condition: Condition | null): string[] {
  return (condition?.contexts ?? []).flatMap((c) =>
    c.rules.flatMap((r) => r.constraints.flatMap((k) => [k.subject.text.trim(), k.object.text.trim()])),
  );
}
// Whether each way to meet the condition gives the variable a value.
function binds(condition: Condition | null, name: string): boolean {
  return (
    condition !== null &&
    eachWayHas(condition, (row) =>
      [row.subject.text, row.object.text].some((t) => t.trim() === `?${name}` || t.trim() === `$${name}`),
    )
  );
}

// Where a variable has its value from when a step of the flow begins; none: nothing gives it one.
export type Source =
  | { from: "initial"; value: string }
  | { from: "activator" } // what starts the flow by itself
  | { from: "start" } // a start by hand, or the flow that runs this one
  | { from: "step"; step: string }
  | { from: "none" };

export function sourceOf(document: CawlDocument, flow: Flow, step: Step, name: string, gives: Gives): Source {
  const { activator } = document;
  const starts = activator?.flow === flow.name;
  const initial = [...flow.variables, ...document.variables, ...(starts ? activator.variables : [])].find(
    (v) => v.name === name && v.initial,
  )?.initial;
  if (initial) return { from: "initial", value: initial };
  if (starts && (binds(activator.condition, name) || (activator.condition?.events.length ?? 0) > 0))
    return { from: "activator" };
  if (binds(step.condition, name)) return { from: "step", step: step.name };
  for (const before of stepsBefore(flow, step))
    if (sets(document, before, name, gives)) return { from: "step", step: before.name };
  if (!starts && [...flow.variables, ...document.variables].some((v) => v.name === name))
    return { from: "start" };
  return { from: "none" };
}

function stepsBefore(flow: Flow, step: Step): Step[] {
  const names = new Set([step.name]);
  for (let size = 0; size < names.size;) {
    size = names.size;
    for (const link of flow.links) if (names.has(link.to)) names.add(link.from);
  }
  names.delete(step.name);
  return flow.steps.filter((s) => names.has(s.name));
}
function sets(document: CawlDocument, step: Step, name: string, gives: Gives): boolean {
  if (binds(step.condition, name)) return true;
  if (assigns(document.text.slice(step.element.from, step.element.to), name)) return true;
  return step.invokes.some(
    (invoke) =>
      !invoke.element.children.some((c) => c.local === "output") && (gives(invoke)?.includes(name) ?? true),
  );
}

export interface Unset {
  flow: Flow;
  step: Step;
  invoke: Invoke;
  input: Taken;
  named: string[]; // things of its class that the situation names which starts the flow: one of them may be meant
}
// What steps that run a flow take, and nothing gives before. `isA`: whether a thing of the document's words is of the class.
export function unsetInputs(
  document: CawlDocument,
  called: ReadonlyMap<string, Called>,
  gives: Gives,
  isA: (term: string, type: string) => boolean,
): Unset[] {
  const prefixes = prefixesOf(document);
  return document.flows.flatMap((flow) =>
    flow.steps.flatMap((step) =>
      step.invokes.flatMap((invoke) => {
        const takes = invoke.kind === "subflow" ? (called.get(invoke.target)?.takes ?? []) : [];
        return takes
          .filter(
            (input) =>
              !input.optional &&
              !invoke.inputs.some((i) => i.part === input.name || i.part.startsWith(`${input.name}.`)),
          )
          .filter((input) => sourceOf(document, flow, step, input.name, gives).from === "none")
          .map((input): Unset => ({
            flow,
            step,
            invoke,
            input,
            named: namedIn(
              document,
              flow,
              (term, own) => iriOf(own, prefixes) === input.type || isA(term, input.type),
            ),
          }));
      }),
    ),
  );
}
function namedIn(
  document: CawlDocument,
  flow: Flow,
  fits: (term: string, ownType: string) => boolean,
): string[] {
  if (document.activator?.flow !== flow.name) return [];
  const slots = neededRows(document.activator.condition).flatMap((row) => [row.subject, row.object]);
  return [
    ...new Set(
      slots
        .filter(
          (s) => /^([A-Za-z][\w-]*:[\w.-]+|<[^<>\s]+>)$/.test(s.text.trim()) && fits(s.text.trim(), s.type),
        )
        .map((s) => s.text.trim()),
    ),
  ];
}
