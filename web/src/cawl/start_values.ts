// The values that a run begins with: which have to be given, and which it finds by itself. Pure functions.
import { neededRows } from "./condition_logic";
import type { CawlDocument, Flow, Variable } from "./document";
import { literally } from "./names";

// needed: without it the run can't go on as it is meant. found: by a condition of a step. made: by a step, which assigns it, gets it
// as a result, or gives what is invoked an input of its own in its place. set: it begins with a value of its own. any: the run takes
// one that is free.
export type Need = "needed" | "found" | "made" | "set" | "any";

const robotVariable = "robot"; // given, it is the robot that the run takes

// The flow that a start by hand runs, where none is named.
export function startFlow(document: CawlDocument): Flow | undefined {
  return document.flows.find((f) => f.name === document.activator?.flow) ?? document.flows[0];
}
function boundBy(flow: Flow | undefined): ReadonlySet<string> {
  const terms =
    flow?.steps.flatMap((s) =>
      neededRows(s.condition).flatMap((row) => [row.subject.text, row.object.text]),
    ) ?? [];
  return new Set(
    terms
      .map((t) => t.trim())
      .filter((t) => t.startsWith("?"))
      .map((t) => t.slice(1)),
  );
}
// Whether the text of a step, or of a flow, assigns the variable or has it as a result of what it invokes.
export function assigns(body: string, name: string): boolean {
  const tags = body.match(/<(?:[\w-]+:)?(?:assign|output)\b[^>]*>/g) ?? [];
  if (tags.some((tag) => new RegExp(`\\bvariable=["']${literally(name)}["']`).test(tag))) return true;
  return [...body.matchAll(/<(?:[\w-]+:)?assign\b[^>]*>([^<]*)</g)].some(([, query = ""]) =>
    new RegExp(`\\?${literally(name)}\\b`).test(query),
  );
}
function isMade(name: string, flow: Flow, text: string): boolean {
  const body = text.slice(flow.element.from, flow.element.to);
  if (assigns(body, name)) return true;
  return (
    !new RegExp(`\\$${name}\\b`).test(body) &&
    flow.steps.some((s) => s.invokes.some((i) => i.inputs.some((input) => input.part === name)))
  );
}
export function needOf(
  { name, initial }: Pick<Variable, "name" | "initial">,
  flow: Flow | undefined,
  text: string,
): Need {
  if (initial) return "set";
  if (boundBy(flow).has(name)) return "found";
  if (name === robotVariable) return "any";
  return flow && /^\w+$/.test(name) && isMade(name, flow, text) ? "made" : "needed";
}

export interface StartVariable {
  name: string;
  type: string;
  initial: string;
  need: Need;
}
// Of a document and its flow: each name once. Only the flow's own can be needed: the others are of the whole document, or what an
// activator binds.
export function startVariables(document: CawlDocument, flow: Flow | undefined): StartVariable[] {
  const own = (flow?.variables ?? []).map(({ name, type, initial }) => ({
    name,
    type,
    initial,
    need: needOf({ name, initial }, flow, document.text),
  }));
  const others = [...document.variables, ...(document.activator?.variables ?? [])].map(
    ({ name, type, initial }) => ({
      name,
      type,
      initial,
      need: initial ? ("set" as const) : ("found" as const),
    }),
  );
  return [...own, ...others].filter((v, i, all) => v.name && all.findIndex((w) => w.name === v.name) === i);
}
